// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/clip.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/error.hpp"
#include "shapes.hpp"

namespace palpate::skull {
namespace {

TEST(Clip, CutsAndClosesASphere) {
  const SurfaceMesh sphere = ellipsoid({80, 80, 80}, 0, 5);
  const registration::CutPlane plane{{0, -1, 0}, 40, 0};  // keeps y > -40
  const Clipped cut = clip_closed(sphere, {plane}, 3);
  const double cap = std::numbers::pi * 40 * 40 * (80 - 40 / 3.0);
  EXPECT_NEAR(cut.removed_mm3, cap, 0.01 * cap);
  EXPECT_NEAR(signed_volume(cut.mesh), signed_volume(sphere) - cut.removed_mm3, 1);
  for (const Vec3& p : cut.mesh.points) EXPECT_GT(p.y(), -40.001);
  EXPECT_EQ(count_self_intersections(cut.mesh), 0u);
  // Euler's formula for one closed surface of genus 0.
  EXPECT_EQ(2 * cut.mesh.points.size() - cut.mesh.triangles.size(), 4u);
  ASSERT_EQ(cut.origin.size(), cut.mesh.points.size());
  for (std::size_t i = 0; i < cut.origin.size(); ++i)
    if (cut.mesh.points[i].y() > -30) {
      EXPECT_EQ(cut.mesh.points[i], sphere.points[cut.origin[i]]);
    }
}

TEST(Clip, SameMeshTwice) {
  const SurfaceMesh sphere = ellipsoid({80, 80, 80}, 0, 5);
  const auto cut = [&] { return clip_closed(sphere, {{{0.1, -1, 0.2}, 30, 0}}, 3); };
  const Clipped a = cut(), b = cut();
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.origin, b.origin);
}

TEST(Clip, NothingLeftIsAnError) {
  const SurfaceMesh sphere = ellipsoid({80, 80, 80}, 0, 3);
  EXPECT_THROW(clip_closed(sphere, {{{0, -1, 0}, -100, 0}}, 3), SolveError);
}

}  // namespace
}  // namespace palpate::skull
