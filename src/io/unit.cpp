// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.hpp"
#include "io/scan.hpp"

namespace palpate::io {
namespace {

struct Candidate {
  LengthUnit unit;
  double rarity;  ///< [-] added to |log(size / head)|: scans in inches and decimetres are rare
};
// A head of 260 mm in centimetres (26) is no bust of 660 mm in inches: rarity 0.5 says how
// strongly.
constexpr std::array<Candidate, 5> kCandidates = {
    Candidate{LengthUnit::mm, 0}, Candidate{LengthUnit::cm, 0}, Candidate{LengthUnit::m, 0},
    Candidate{LengthUnit::dm, 0.5}, Candidate{LengthUnit::inch, 0.5}};
constexpr double kHeadMm = 260;      // crown to neck of an adult
constexpr double kSmallestMm = 120;  // a face mask of a child
constexpr double kLargestMm = 1200;  // a bust with shoulders and arms
constexpr double kHeadLowMm = 170;   // a face alone
constexpr double kHeadHighMm = 520;  // a head with shoulders

/// Longest side of the box around the middle 99 % of the vertices that faces use, so that a few
/// stray points do not count.
double extent(const SurfaceMesh& scan) {
  std::vector<bool> used(scan.points.size(), false);
  for (const Triangle& t : scan.triangles)
    for (const std::int32_t c : t) used[static_cast<std::size_t>(c)] = true;
  double longest = 0;
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      if (used[i]) values.push_back(scan.points[i][axis]);
    if (values.empty()) return 0;
    const std::size_t skip = values.size() / 200;
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(skip);
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(skip);
    std::nth_element(values.begin(), low, values.end());
    const double lowest = *low;
    std::nth_element(values.begin(), high, values.end());
    longest = std::max(longest, *high - lowest);
  }
  return longest;
}

}  // namespace

UnitGuess guess_unit(const SurfaceMesh& scan) {
  const double size = extent(scan);
  UnitGuess guess;
  double best = std::numeric_limits<double>::infinity(), second = best;
  int plausible = 0;
  for (const Candidate& c : kCandidates) {
    const double mm = size * millimetres(c.unit);
    if (!(mm >= kSmallestMm && mm <= kLargestMm)) continue;
    plausible += mm >= kHeadLowMm && mm <= kHeadHighMm;
    const double score = std::abs(std::log(mm / kHeadMm)) + c.rarity;
    if (score < best) {
      if (std::isfinite(best)) guess.other = guess.unit;
      second = best;
      best = score;
      guess.unit = c.unit;
    } else if (score < second) {
      second = score;
      guess.other = c.unit;
    }
  }
  if (!std::isfinite(best))
    throw InputError(
        fmt::format("the scan measures {:.4g} units across, and no unit (mm, cm, dm, "
                    "m, inch) makes that a head; give --unit, or cut the head out",
                    size));
  const double mm = size * millimetres(guess.unit);
  guess.certain = plausible == 1 && mm >= kHeadLowMm && mm <= kHeadHighMm;
  return guess;
}

}  // namespace palpate::io
