// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/clearance.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "skull/clip.hpp"

namespace palpate::skull {
namespace {

TEST(Clearance, LeavesBoneThatIsDeepEnoughAlone) {
  const SkinField skin(head_of(ellipsoid({80, 90, 100}, 0, 5)));
  SurfaceMesh bone = ellipsoid({80, 90, 100}, -4, 4);
  const std::vector<Vec3> before = bone.points;
  std::vector<Vec3> riders = {{0, 0, 0}};
  const ClearanceReport report = keep_clear(bone.points, riders, skin, {}, {});
  EXPECT_EQ(report.pushed, 0u);
  EXPECT_EQ(bone.points, before);
}

TEST(Clearance, BringsEveryPointUnderTheSkinWithoutFolding) {
  const SkinField skin(head_of(ellipsoid({80, 90, 100}, 0, 5)));
  SurfaceMesh bone = ellipsoid({70, 80, 90}, 0, 5);
  for (Vec3& p : bone.points) p += Vec3(14, 3, 0);  // sticks out on one side by 4 mm
  std::vector<Vec3> riders = {bone.points[0]};
  const ClearanceReport report = keep_clear(bone.points, riders, skin, {}, {});
  EXPECT_GT(report.pushed, 10u);
  EXPECT_EQ(report.remaining, 0u);
  for (const Vec3& p : bone.points) EXPECT_GE(skin.depth(p), 2.5);
  EXPECT_EQ(count_self_intersections(bone), 0u);
  EXPECT_EQ(riders[0], bone.points[0]);  // a landmark stays on its vertex
}

TEST(Clearance, AThinPlateGoesInWithBothFaces) {
  const SkinField skin(head_of(ellipsoid({80, 90, 100}, 0, 5)));
  SurfaceMesh plate = ellipsoid({2, 20, 20}, 0, 4);  // 4 mm thick, 1 mm outside at its middle
  for (Vec3& p : plate.points) p += Vec3(79, 0, 0);
  std::vector<Vec3> none;
  const ClearanceReport report = keep_clear(plate.points, none, skin, {}, {});
  EXPECT_EQ(report.remaining, 0u);
  EXPECT_EQ(count_self_intersections(plate), 0u);
  EXPECT_GT(signed_volume(plate), 0.4 * signed_volume(ellipsoid({2, 20, 20}, 0, 4)));
}

TEST(Clearance, SaysSoWhereBoneHasNoRoom) {
  const SkinField skin(head_of(ellipsoid({2, 90, 100}, 0, 5)));  // a skin 4 mm thick
  SurfaceMesh bone = ellipsoid({1, 10, 10}, 0, 2);
  std::vector<Vec3> none;
  EXPECT_GT(keep_clear(bone.points, none, skin, {}, {}).remaining, 0u);
}

}  // namespace
}  // namespace palpate::skull
