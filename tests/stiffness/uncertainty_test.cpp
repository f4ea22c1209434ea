// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/uncertainty.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes.hpp"
#include "stiffness/press_sites.hpp"

namespace palpate::stiffness {
namespace {

TEST(LayerSensitivity, IsHertzOverDeepTissue) {
  const LayerSensitivity s = layer_sensitivity(0.05, 200, 8);
  EXPECT_EQ(s.to_depth, 0);
  EXPECT_DOUBLE_EQ(s.to_modulus, 2.0 / 3);
}

TEST(LayerSensitivity, ThinTissueAnswersMoreAndStaysBounded) {
  double before = 0;
  for (const double depth : {60.0, 30.0, 15.0, 8.0, 4.0}) {
    const LayerSensitivity s = layer_sensitivity(2, depth, 8);
    EXPECT_LE(s.to_depth, before) << depth;  // stiffer where thinner
    EXPECT_GT(s.to_depth, -2) << depth;
    EXPECT_GT(s.to_modulus, 0.3) << depth;
    EXPECT_LT(s.to_modulus, 0.7) << depth;
    before = s.to_depth;
  }
  EXPECT_LT(before, -0.5);
}

TEST(DepthResponse, FindsTheSlopeOfAPowerLaw) {
  std::vector<double> depth, stiffness;
  for (int i = 0; i < 4000; ++i) {
    depth.push_back(3 * std::pow(10, i / 4000.0));
    stiffness.push_back(7 * std::pow(depth.back(), -0.8));
  }
  stiffness[7] = std::nan("");
  const DepthResponse response(depth, stiffness);
  for (const double d : {3.0, 6.0, 12.0, 30.0}) EXPECT_NEAR(response.at(d, 9), -0.8, 1e-6);
  EXPECT_EQ(DepthResponse({5, 6}, {1, 2}).at(5, -0.5), -0.5);  // too few
  EXPECT_EQ(DepthResponse({}, {}).at(5, -0.5), -0.5);
}

/// A head with a curve everywhere, and two draws that lie `shift` deeper and shallower.
struct Scene {
  scenes::Head head = scenes::head(3);
  StiffnessMap map;

  explicit Scene(double shift) {
    for (const double way : {-1.0, 1.0}) {
      std::vector<Vec3> draw = head.skull.mesh.points;
      for (Vec3& p : draw) p += way * shift * p.normalized();
      if (shift > 0) head.skull.draws.push_back(draw);
    }
    map.forces = {1, 2};
    const std::size_t n = head.skin.skin.points.size();
    for (std::size_t v = 0; v < n; ++v) map.displacement.insert(map.displacement.end(), {1.0, 1.6});
    map.status.assign(n, VertexStatus::solved);
    map.error.assign(n, 0.0);
    map.depth.assign(n, 8);
    map.region.assign(n, SkinRegion::cheek);
  }
  [[nodiscard]] MapSpread spread(double modulus) const {
    SpreadOptions options;
    options.modulus_spread = modulus;
    return map_spread(map, head.skin, head.skull, head.skin.skin.points, options);
  }
};

TEST(MapSpread, DepthIsThatOfTheDraws) {
  const MapSpread s = Scene(1.5).spread(0);
  for (const double d : s.depth) EXPECT_NEAR(d, 1.5, 0.15);
  const LayerSensitivity one = layer_sensitivity(1.6, 8, 8);
  for (std::size_t v = 0; v < s.depth.size(); ++v)
    EXPECT_NEAR(s.stiffness[v], -one.to_depth * s.depth[v] / 8, 1e-12);
}

TEST(MapSpread, AMeasuredSkullLeavesTheModulus) {
  const MapSpread s = Scene(0).spread(0.3);
  const LayerSensitivity one = layer_sensitivity(1.6, 8, 8);
  for (std::size_t v = 0; v < s.depth.size(); ++v) {
    EXPECT_EQ(s.depth[v], 0);
    EXPECT_NEAR(s.stiffness[v], 0.3 * one.to_modulus, 1e-12);
  }
}

TEST(MapSpread, IsMissingWhereTheMapIs) {
  Scene scene(1);
  scene.map.depth[3] = std::nan("");
  scene.map.status[5] = VertexStatus::held;
  const MapSpread s = scene.spread(0.3);
  EXPECT_TRUE(std::isnan(s.depth[3]));
  EXPECT_TRUE(std::isnan(s.stiffness[3]));
  EXPECT_TRUE(std::isfinite(s.depth[5]));
  EXPECT_TRUE(std::isnan(s.stiffness[5]));
}

TEST(RestsOnCompleted, IsSkinThatAPressMoves) {
  Scene scene(0);
  const std::vector<Vec3>& points = scene.head.skin.skin.points;
  std::vector<std::uint8_t>& filled = scene.head.skin.filled;
  filled.assign(points.size(), 1);
  EXPECT_TRUE(rests_on_completed(scene.map, scene.head.skin, points).empty());  // closed holes only
  std::size_t top = 0;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (points[v].y() > points[top].y()) top = v;
  filled[top] = 2;
  const auto expect_reach = [&](double reach) {
    const auto marked = rests_on_completed(scene.map, scene.head.skin, points);
    ASSERT_EQ(marked.size(), points.size());
    std::size_t count = 0;
    for (std::size_t v = 0; v < points.size(); ++v) {
      EXPECT_EQ(marked[v], (points[v] - points[top]).norm() <= reach) << v;
      count += marked[v];
    }
    EXPECT_GT(count, 1u);
    EXPECT_LT(count, points.size());
  };
  expect_reach(rule_for_depth(8, scene.map.tool_radius).touch_radius);  // no dents
  scene.map.dents.radii = {0, 12, 24, 36};
  for (std::size_t v = 0; v < points.size(); ++v)
    scene.map.dents.share.insert(scene.map.dents.share.end(), {1.0, 0.3, 0.01, 0.0});
  expect_reach(24);  // the share falls below 2 % between 12 and 24 mm
}

}  // namespace
}  // namespace palpate::stiffness
