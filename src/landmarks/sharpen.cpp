// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/sharpen.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::landmarks {
namespace {

struct Cell {
  double x, y, z;  // [mm]
};
struct Cap {
  Cell top{0, 0, 0};
  double x = 0, y = 0;  // [mm] middle, weighted by height
  double weight = 0;    // [mm] sum of the heights above the cap's rim
  int cells = 0;        // of the cap that lie around its top
};

Cap cap_of(const std::vector<Cell>& cells) {
  constexpr double kDepth = 0.5, kAround = 4;  // [mm]
  Cap cap;
  cap.top = *std::max_element(cells.begin(), cells.end(),
                              [](const Cell& a, const Cell& b) { return a.z < b.z; });
  for (const Cell& cell : cells) {
    const double w = std::max(0.0, cell.z - (cap.top.z - kDepth));
    cap.weight += w;
    cap.x += w * cell.x;
    cap.y += w * cell.y;
    cap.cells += w > 0 && std::hypot(cell.x - cap.top.x, cell.y - cap.top.y) < kAround;
  }
  cap.x /= cap.weight;
  cap.y /= cap.weight;
  return cap;
}

}  // namespace

// The tip is the middle of the cap that stands out most along the head's z. Landmark sets disagree
// on where a hanging or bulbous tip has its point, by 4 mm along the nose's ridge; the foremost
// place lies between (measured: 5 degrees more or less of pitch moves it by 0.6 mm). The cap's
// depth averages over facets and noise where the tip is nearly flat. A cap that comes to a point is
// a bad point of the scan: what that lifted is left out, and the next cap is taken.
Vec3 sharpen_nose_tip(const Relief& relief, const Vec3& guess) {
  constexpr double kUpDown = 9;  // [mm] of the guess; the model's error is 6 mm at most
  constexpr double kAcross = 5;  // [mm] the same from side to side, where it is symmetric
  constexpr double kBlunt = 6;   // [mm^2] a cap of 2 mm radius: no tip is sharper
  constexpr double kFoot = 4.5;  // [mm] around a spike
  constexpr int kMostSpikes = 3;
  std::vector<Cell> cells;
  for (int r = 0; r < relief.rows; ++r)
    for (int c = 0; c < relief.columns; ++c) {
      const Cell cell{relief.x(c), relief.y(r), relief.at(c, r)};
      const double across = (cell.x - guess.x()) / kAcross, up = (cell.y - guess.y()) / kUpDown;
      if (std::hypot(across, up) <= 1 && std::isfinite(cell.z)) cells.push_back(cell);
    }
  if (cells.empty()) return guess;
  Cap cap = cap_of(cells);
  for (int spikes = 0; cap.cells * relief.step * relief.step < kBlunt; ++spikes) {
    std::erase_if(cells, [&](const Cell& cell) {
      return std::hypot(cell.x - cap.top.x, cell.y - cap.top.y) < kFoot;
    });
    if (cells.empty() || spikes == kMostSpikes) return guess;
    cap = cap_of(cells);
  }
  const double z = relief.height(cap.x, cap.y);
  return std::isfinite(z) ? Vec3(cap.x, cap.y, z) : guess;
}

namespace {

// One horizontal profile across a nose wing: where it falls steepest and where it ends in the
// crease.
struct WingRow {
  double y = 0;         // [mm]
  double slope = 0;     // [-] largest fall
  double steepest = 0;  // [mm] |x| of it
  double crease = 0;    // [mm] |x| of the sharpest valley at or beyond it
};

WingRow wing_row(const Relief& relief, double y, double side, double from, double to) {
  constexpr double kSlopeBase = 1, kValleyBase = 2;  // [mm] half widths of the differences
  WingRow row{.y = y};
  for (double a = from; a <= to; a += relief.step) {
    const double fall =
        (relief.height(side * (a - kSlopeBase), y) - relief.height(side * (a + kSlopeBase), y)) /
        (2 * kSlopeBase);
    if (fall > row.slope) {
      row.slope = fall;
      row.steepest = a;
    }
  }
  double sharpest = 0;
  row.crease = row.steepest;
  for (double a = row.steepest; a <= row.steepest + 4; a += relief.step) {
    const double bend = relief.height(side * (a - kValleyBase), y) +
                        relief.height(side * (a + kValleyBase), y) - 2 * relief.height(side * a, y);
    if (bend > sharpest) {
      sharpest = bend;
      row.crease = a;
    }
  }
  return row;
}

// Each row as most of those around it are: a spike of the scan beside the nose (one bad point of
// it) is steep over a row or three, a wing's wall over ten and more.
std::vector<WingRow> without_spikes(const std::vector<WingRow>& rows, int reach) {
  std::vector<WingRow> calm = rows;
  const int n = static_cast<int>(rows.size());
  for (int i = 0; i < n; ++i) {
    std::vector<WingRow> around(rows.begin() + std::max(0, i - reach),
                                rows.begin() + std::min(n, i + reach + 1));
    const auto middle = around.begin() + around.size() / 2;
    std::nth_element(around.begin(), middle, around.end(),
                     [](const WingRow& a, const WingRow& b) { return a.steepest < b.steepest; });
    calm[i].steepest = middle->steepest;
    calm[i].crease = middle->crease;
  }
  return calm;
}

// The height at a place, but not that of a spike: no more than 3 mm off the median of the heights
// within 4 mm above and below.
double height_on_wall(const Relief& relief, double x, double y) {
  constexpr double kUpDown = 4, kMost = 3;  // [mm]
  std::vector<double> heights;
  for (double at = y - kUpDown; at <= y + kUpDown; at += relief.step)
    if (const double z = relief.height(x, at); std::isfinite(z)) heights.push_back(z);
  if (heights.empty()) return relief.height(x, y);
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return std::clamp(relief.height(x, y), *middle - kMost, *middle + kMost);
}

}  // namespace

// The wing's wall stands between the steepest place and the crease; the corner is half way, at the
// height where the wall stands farthest out (the middle of the rows within 1.5 mm of that).
Vec3 sharpen_nose_corner(const Relief& relief, const Vec3& guess) {
  constexpr double kUpDown = 8, kAcross = 7, kFarthest = 1.5;  // [mm]; the guess errs by 5 at most
  constexpr double kSpike = 2;  // [mm] half of the height that a spike's rows stay below
  const double side = guess.x() > 0 ? 1 : -1, a = std::abs(guess.x());
  std::vector<WingRow> rows;
  double steepest = 0, widest = 0;
  for (double y = guess.y() - kUpDown; y <= guess.y() + kUpDown; y += relief.step) {
    rows.push_back(wing_row(relief, y, side, std::max(4.0, a - kAcross), a + kAcross));
    steepest = std::max(steepest, rows.back().slope);
  }
  // Rows above and below the wing fall gently; where even the steepest does, there is no wing. What
  // overhangs (a hooked tip) is steeper than any wing and must not set the scale.
  constexpr double kGentlest = 1, kSteepWing = 4;  // [-] 45 and 76 degrees
  if (steepest < kGentlest) return guess;
  rows = without_spikes(rows, static_cast<int>(kSpike / relief.step));
  const double enough = 0.5 * std::min(steepest, kSteepWing);
  const auto counts = [&](const WingRow& row) { return row.slope > enough; };
  for (const WingRow& row : rows) {
    if (counts(row)) widest = std::max(widest, row.steepest);
  }
  double weight = 0, x = 0, y = 0;
  for (const WingRow& row : rows) {
    const double w = counts(row) ? std::max(0.0, row.steepest - (widest - kFarthest)) : 0;
    weight += w;
    x += w * 0.5 * (row.steepest + row.crease);
    y += w * row.y;
  }
  if (weight <= 0) return guess;
  const Vec3 corner(side * x / weight, y / weight,
                    height_on_wall(relief, side * x / weight, y / weight));
  // Farther off than the guess ever errs, it is not the wing that was found.
  constexpr double kTrust = 6;  // [mm]; on good scans the two lie 0.2 to 3 mm apart
  const double apart = std::hypot(corner.x() - guess.x(), corner.y() - guess.y());
  return corner.allFinite() && apart < kTrust ? corner : guess;
}

}  // namespace palpate::landmarks
