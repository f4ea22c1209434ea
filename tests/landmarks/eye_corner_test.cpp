// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "landmarks/sharpen.hpp"

namespace palpate::landmarks {
namespace {

/// A plane z = 0 around the origin, 1 mm fine, with a hole of given half width, 10 high.
SurfaceMesh plane(double half_width) {
  constexpr int kSide = 100;
  SurfaceMesh m;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i) m.points.push_back({i - kSide / 2.0, j - kSide / 2.0, 0});
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const std::int32_t a = j * (kSide + 1) + i, b = a + 1, c = a + kSide + 1, d = c + 1;
      const double x = i + 0.5 - kSide / 2.0, y = j + 0.5 - kSide / 2.0;
      if (half_width > 0 && std::hypot(x / half_width, y / 5) < 1) continue;
      m.triangles.push_back({a, b, d});
      m.triangles.push_back({a, d, c});
    }
  return m;
}

std::optional<Vec3> corner(double half_width) {
  const SurfaceMesh closed = plane(0), scan = plane(half_width);
  return open_eye_corner(surface::SurfaceQuery(scan), surface::SurfaceQuery(closed), {},
                         {-13, 0, 0}, {13, 0, 0});
}

TEST(EyeCorner, IsTheOuterEndOfAnOpenEye) {
  const auto found = corner(15);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - Vec3(15, 0, 0)).norm(), 1.5);
}

// The scanner left it between the lids; its end lies a centimetre inside of the corner.
TEST(EyeCorner, AHoleNarrowerThanAFissureIsNoOpenEye) {
  EXPECT_FALSE(corner(0));
  EXPECT_FALSE(corner(7.5));
}

}  // namespace
}  // namespace palpate::landmarks
