// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {
namespace {

/// A map with u = (1, 2) (1 + x/1000), so that mixing can be checked by hand.
StiffnessMap linear_map(const HeadSurface& head) {
  const std::size_t n = head.skin.points.size();
  StiffnessMap m;
  m.forces = {1, 2};
  for (const Vec3& p : head.skin.points)
    for (const double f : m.forces) m.displacement.push_back(f * (1 + p.x() / 1000));
  m.status.assign(n, VertexStatus::blended);
  m.error.assign(n, 0.03);
  m.depth.assign(n, 5);
  m.region = head.region;
  return m;
}

struct Scene {
  scenes::Head head = scenes::head(3);
  StiffnessMap map = linear_map(head.skin);
  StiffnessMap at(const std::vector<Vec3>& points, SkinRegion region = SkinRegion::cheek,
                  Organs organs = Organs::supported) const {
    return transfer(map, head.skin, head.skull,
                    {points, std::vector<SkinRegion>(points.size(), region)}, {organs});
  }
  Vec3 middle(int triangle) const {
    const Triangle& t = head.skin.skin.triangles[triangle];
    const auto& p = head.skin.skin.points;
    return (p[t[0]] + p[t[1]] + p[t[2]]) / 3;
  }
};

TEST(Transfer, MixesTheCornersLinearly) {
  const Scene s;
  const Vec3 p = s.middle(17);
  const StiffnessMap out = s.at({p});
  EXPECT_EQ(out.status[0], VertexStatus::blended);
  EXPECT_NEAR(out.curve(0)[1], 2 * (1 + p.x() / 1000), 1e-9);
  EXPECT_NEAR(out.error[0], 0.03, 1e-12);
  EXPECT_GT(out.depth[0], 2);
}

TEST(Transfer, KeepsSolvedOnlyOnTheSolvedPoint) {
  Scene s;
  s.map.status[40] = VertexStatus::solved;
  const Vec3 on = s.head.skin.skin.points[40];
  const StiffnessMap out = s.at({on, on + Vec3(0.1, 0.1, 0.1)});
  EXPECT_EQ(out.status[0], VertexStatus::solved);
  EXPECT_EQ(out.curve(0)[0], s.map.curve(40)[0]);
  EXPECT_EQ(out.status[1], VertexStatus::blended);
}

TEST(Transfer, LeavesOutCornersWithoutACurve) {
  Scene s;
  const Triangle t = s.head.skin.skin.triangles[17];
  s.map.status[t[0]] = VertexStatus::no_bone;
  const auto& p = s.head.skin.skin.points;
  const Vec3 near_bare = 0.8 * p[t[0]] + 0.1 * (p[t[1]] + p[t[2]]);
  const Vec3 near_good = 0.2 * p[t[0]] + 0.6 * p[t[1]] + 0.2 * p[t[2]];
  const StiffnessMap out = s.at({near_bare, near_good});
  EXPECT_EQ(out.status[0], VertexStatus::no_bone);
  EXPECT_TRUE(std::isnan(out.curve(0)[0]));
  EXPECT_EQ(out.status[1], VertexStatus::blended);
  const double expected = 0.75 * s.map.curve(t[1])[0] + 0.25 * s.map.curve(t[2])[0];
  EXPECT_NEAR(out.curve(1)[0], expected, 1e-9);
}

TEST(Transfer, OrgansEarsAndPointsOffTheSkinHaveNoCurve) {
  const Scene s;
  EXPECT_EQ(s.at({s.middle(3)}, SkinRegion::lips, Organs::held).status[0], VertexStatus::held);
  EXPECT_EQ(s.at({s.middle(3)}, SkinRegion::lips).status[0], VertexStatus::blended);
  EXPECT_EQ(s.at({s.middle(3)}, SkinRegion::ear).status[0], VertexStatus::no_bone);
  EXPECT_EQ(s.at({1.2 * s.middle(3)}).status[0], VertexStatus::no_bone);
  EXPECT_TRUE(s.at({}).status.empty());
}

}  // namespace
}  // namespace palpate::stiffness
