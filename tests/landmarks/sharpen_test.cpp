// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/sharpen.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::landmarks {
namespace {

/// A ridge along y whose walls end at |x| = 17, 14 mm tall in y, on a flat cheek.
Relief nose() {
  Relief relief;
  relief.step = 0.5;
  relief.left = -35;
  relief.low = -25;
  relief.columns = 141;
  relief.rows = 101;
  for (int r = 0; r < relief.rows; ++r)
    for (int c = 0; c < relief.columns; ++c) {
      const double wide = 17 - 0.1 * std::pow(relief.y(r), 2);
      relief.z.push_back(8 / (1 + std::exp((std::abs(relief.x(c)) - wide + 1) / 0.5)));
    }
  return relief;
}

TEST(NoseCorner, IsAtTheFootOfTheWall) {
  const Vec3 corner = sharpen_nose_corner(nose(), {18, 2, 0});
  EXPECT_NEAR(corner.x(), 16.5, 1);
  EXPECT_NEAR(corner.y(), 0, 0.5);
  EXPECT_NEAR(sharpen_nose_corner(nose(), {-18, 2, 0}).x(), -corner.x(), 1e-9);
}

// One bad point of a scan beside the nose: steeper than the wing, and farther out.
TEST(NoseCorner, ASpikeBesideTheNoseIsNoWing) {
  Relief spiked = nose();
  for (int r = 0; r < spiked.rows; ++r)
    for (int c = 0; c < spiked.columns; ++c) {
      const double off = std::hypot(spiked.x(c) - 23, spiked.y(r) + 5);
      spiked.z[r * spiked.columns + c] += std::max(0.0, 9 - 6 * off);
    }
  const Vec3 corner = sharpen_nose_corner(spiked, {18, 2, 0});
  EXPECT_LT((corner - sharpen_nose_corner(nose(), {18, 2, 0})).norm(), 0.5);
}

/// A nose like a cone that is rounded over 8 mm, with its tip at (0, 0), and a bad point beside it.
Relief tip_with_spike(double height, double at_x, double at_y) {
  Relief relief;
  relief.step = 1;
  relief.left = relief.low = -30;
  relief.columns = relief.rows = 61;
  for (int r = 0; r < relief.rows; ++r)
    for (int c = 0; c < relief.columns; ++c) {
      const double x = relief.x(c), y = relief.y(r);
      const double off = std::hypot(x - at_x, y - at_y);
      relief.z.push_back(-std::sqrt(64 + x * x + 0.5 * y * y) +
                         std::max(0.0, height * (1 - off / 4.5)));
    }
  return relief;
}

TEST(NoseTip, ASpikeIsNoTip) {
  const Vec3 guess(1, 3, 0);
  const Vec3 tip = sharpen_nose_tip(tip_with_spike(0, 0, 0), guess);
  EXPECT_LT(tip.head<2>().norm(), 0.3);
  for (const double height : {3.0, 6.0, 10.0})
    for (const auto& [x, y] : {std::pair(5.0, 0.0), {-2.0, 8.0}, {0.0, -6.0}, {-6.0, 3.0}})
      EXPECT_LT((sharpen_nose_tip(tip_with_spike(height, x, y), guess) - tip).norm(), 3)
          << height << " at " << x << ", " << y;
}

TEST(NoseCorner, ASpikeOnTheWallDoesNotLiftIt) {
  Relief spiked = nose();
  for (int r = 0; r < spiked.rows; ++r)
    for (int c = 0; c < spiked.columns; ++c) {
      const double off = std::hypot(spiked.x(c) - 16.5, spiked.y(r));
      spiked.z[r * spiked.columns + c] += std::max(0.0, 10 - 5 * off);
    }
  const Vec3 corner = sharpen_nose_corner(spiked, {18, 2, 0});
  EXPECT_LT((corner - sharpen_nose_corner(nose(), {18, 2, 0})).norm(), 4);
}

}  // namespace
}  // namespace palpate::landmarks
