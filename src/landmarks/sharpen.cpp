// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/sharpen.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::landmarks {

// The tip is the middle of the cap that stands out most. The direction is 5 degrees above the head's
// z: people place pronasale on the dome's apex, and the columella below pulls the foremost point of
// a hanging tip down. The cap's depth averages over facets and noise of a tip that is nearly flat.
Vec3 sharpen_nose_tip(const Relief& relief, const Vec3& guess) {
  constexpr double kReach = 9;      // [mm] of the guess; the model's error is 6 mm at most
  constexpr double kCapDepth = 0.5;  // [mm]
  const double slope = std::tan(5 * std::numbers::pi / 180);
  const auto standing = [&](int column, int row) {
    return relief.at(column, row) + slope * (relief.low + row * kReliefStep);
  };
  const int c0 = static_cast<int>(std::lround((guess.x() - relief.left) / kReliefStep));
  const int r0 = static_cast<int>(std::lround((guess.y() - relief.low) / kReliefStep));
  const int reach = static_cast<int>(kReach / kReliefStep);
  double top = -1e9;
  const auto visit = [&](auto&& use) {
    for (int r = std::max(0, r0 - reach); r <= std::min(relief.rows - 1, r0 + reach); ++r) {
      for (int c = std::max(0, c0 - reach); c <= std::min(relief.columns - 1, c0 + reach); ++c) {
        if (std::hypot(c - c0, r - r0) <= reach && std::isfinite(relief.at(c, r))) use(c, r);
      }
    }
  };
  visit([&](int c, int r) { top = std::max(top, standing(c, r)); });
  double weight = 0, x = 0, y = 0;
  visit([&](int c, int r) {
    const double w = std::max(0.0, standing(c, r) - (top - kCapDepth));
    weight += w;
    x += w * (relief.left + c * kReliefStep);
    y += w * (relief.low + r * kReliefStep);
  });
  if (weight <= 0) return guess;
  const double z = relief.height(x / weight, y / weight);
  return std::isfinite(z) ? Vec3(x / weight, y / weight, z) : guess;
}

}  // namespace palpate::landmarks
