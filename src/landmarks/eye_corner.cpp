// SPDX-License-Identifier: GPL-3.0-or-later
// Seen from in front, an open eye is where the scan lies behind the closed surface, or is missing.
// The opening is a lens whose outer end is the outer corner; its inner end is not the inner corner,
// which lies a few millimetres on, beyond the caruncle.
#include <algorithm>
#include <cmath>
#include <vector>

#include "landmarks/sharpen.hpp"

namespace palpate::landmarks {
namespace {

constexpr double kStep = 0.5;      // [mm]
constexpr double kDeeper = 1.5;    // [mm] behind the closed surface; noise and facets stay below
constexpr double kMargin = 9;      // [mm] around the guesses; their errors are 7 mm at most
constexpr double kNarrowest = 20;  // [mm] opening; adults' fissures are 25 to 36 mm wide
constexpr double kWidest = 42;     // [mm]
constexpr double kTallest = 20;    // [mm]

struct Opening {
  std::vector<int> cells;  // row * columns + column
};

// The largest 4-connected set of open cells.
Opening largest_opening(const Relief& closed, const Relief& scan) {
  const int n = closed.columns * closed.rows;
  std::vector<char> open(n);
  for (int i = 0; i < n; ++i) {
    open[i] = std::isfinite(closed.z[i]) && !(scan.z[i] > closed.z[i] - kDeeper);
  }
  Opening best;
  for (int seed = 0; seed < n; ++seed) {
    if (!open[seed]) continue;
    Opening grown;
    grown.cells.push_back(seed);
    open[seed] = 0;
    for (std::size_t k = 0; k < grown.cells.size(); ++k) {
      const int cell = grown.cells[k], column = cell % closed.columns;
      const auto reach = [&](bool inside, int to) {
        if (inside && to >= 0 && to < n && open[to]) {
          open[to] = 0;
          grown.cells.push_back(to);
        }
      };
      reach(column > 0, cell - 1);
      reach(column + 1 < closed.columns, cell + 1);
      reach(true, cell - closed.columns);
      reach(true, cell + closed.columns);
    }
    if (grown.cells.size() > best.cells.size()) best = std::move(grown);
  }
  return best;
}

}  // namespace

std::optional<Vec3> open_eye_corner(const surface::SurfaceQuery& scan,
                                    const surface::SurfaceQuery& skin, const HeadFrame& frame,
                                    const Vec3& inner, const Vec3& outer) {
  const auto [x_low, x_high] = std::minmax(inner.x(), outer.x());
  const double middle = 0.5 * (inner.y() + outer.y());
  const ReliefArea area{x_low - kMargin, x_high + kMargin, middle - 16, middle + 16};
  const Relief closed = cast_relief(skin, frame, area, kStep);
  const Relief seen = cast_relief(scan, frame, area, kStep);
  const Opening opening = largest_opening(closed, seen);
  if (opening.cells.empty()) return std::nullopt;

  const double side = outer.x() > inner.x() ? 1 : -1;
  double first = 1e9, last = -1e9, low = 1e9, high = -1e9;  // along side * x, and y
  for (int cell : opening.cells) {
    const double x = side * closed.x(cell % closed.columns), y = closed.y(cell / closed.columns);
    first = std::min(first, x);
    last = std::max(last, x);
    low = std::min(low, y);
    high = std::max(high, y);
  }
  const double width = last - first;
  if (width < kNarrowest || width > kWidest || high - low > kTallest) return std::nullopt;

  constexpr double kEnd = 1;  // [mm] the opening's last cells: their mean height is the corner's
  double y = 0;
  int n = 0;
  for (int cell : opening.cells) {
    if (side * closed.x(cell % closed.columns) < last - kEnd) continue;
    y += closed.y(cell / closed.columns);
    ++n;
  }
  const Vec3 corner(side * last, y / n, closed.height(side * last, y / n));
  if (!corner.allFinite() || (corner - outer).norm() > kMargin + 3) return std::nullopt;
  return corner;
}

}  // namespace palpate::landmarks
