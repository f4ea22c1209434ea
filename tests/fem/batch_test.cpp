// SPDX-License-Identifier: GPL-3.0-or-later
// The single-precision batch against the double-precision reference.
#include "fem/lanes/batch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stiffness/site.hpp"

namespace palpate::fem::lanes {
namespace {

using stiffness::PatchGeometry;
using stiffness::PatchTemplate;

/// A coarse patch: the arithmetic is the same, the factorisation cheap.
PatchTemplate coarse_template() {
  stiffness::PatchRule rule;
  rule.rings = {{3, 6}, {7, 8}, {16, 6}, {40, 6}};
  rule.layers = 2;
  rule.touch_radius = 13;
  rule.hold_rim = false;
  return stiffness::make_template(rule);
}

const LameModuli kFlesh = lame_moduli(0.045658, 0.43);
const std::vector<double> kForces = {0.5, 1, 2, 3.5, 5};

std::vector<BatchPatch> patches(const PatchTemplate& t, int count) {
  std::vector<BatchPatch> out;
  for (int i = 0; i < count; ++i) {
    PatchGeometry g;
    for (const auto& c : t.columns) {
      g.height.push_back(-(c.x * c.x + c.y * c.y) / (2 * (60 + 10 * i)));
      g.thickness.push_back((3 + 0.9 * i) * (1 + 0.2 * std::sin(c.x / 20 + i)));
    }
    out.push_back({stiffness::patch_nodes(t, g, 2.5), {kFlesh}});
  }
  return out;
}

TEST(Batch, AgreesWithDoublePrecision) {
  const PatchTemplate t = coarse_template();
  const Plan plan = make_plan(t.topology);
  const auto nodes = patches(t, 16);
  BatchPress batch(t.topology, plan, best_instruction_set());
  BatchOptions options;
  options.relative_tolerance = 1e-4;
  const auto lanes = batch.press(nodes, 8, kForces, {}, options);
  Cholesky cholesky(t.topology.pattern);
  for (int l = 0; l < 16; ++l) {
    const auto curve =
        stiffness::press_site(t, nodes[l].nodes, neo_hookean(kFlesh), {}, kForces, cholesky);
    ASSERT_EQ(curve.travel.size(), kForces.size());
    ASSERT_EQ(lanes[l].travel.size(), kForces.size());
    for (std::size_t i = 0; i < kForces.size(); ++i)
      EXPECT_NEAR(lanes[l].travel[i] / curve.travel[i], 1, 2e-3) << "lane " << l << " load " << i;
  }
}

TEST(Batch, InstructionSetsAgree) {
  const PatchTemplate t = coarse_template();
  const Plan plan = make_plan(t.topology);
  const auto nodes = patches(t, 16);
  const auto reference =
      BatchPress(t.topology, plan, InstructionSet::baseline).press(nodes, 8, kForces);
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
    if (set > best_instruction_set()) continue;
    const auto lanes = BatchPress(t.topology, plan, set).press(nodes, 8, kForces);
    for (int l = 0; l < 16; ++l)
      for (std::size_t i = 0; i < kForces.size(); ++i)
        EXPECT_NEAR(lanes[l].travel.at(i) / reference[l].travel.at(i), 1, 2e-3);
  }
}

TEST(Batch, ALaneDoesNotFeelTheOthers) {
  const PatchTemplate t = coarse_template();
  const Plan plan = make_plan(t.topology);
  auto nodes = patches(t, 16);
  BatchPress batch(t.topology, plan, best_instruction_set());
  const auto together = batch.press(nodes, 8, kForces);
  std::reverse(nodes.begin(), nodes.end());
  const auto reversed = batch.press(nodes, 8, kForces);
  const auto alone = batch.press(std::span(nodes).first(1), 8, kForces);
  for (int l = 0; l < 16; ++l) EXPECT_EQ(together[l].travel, reversed[15 - l].travel);
  EXPECT_EQ(alone[0].travel, together[15].travel);
}

}  // namespace
}  // namespace palpate::fem::lanes
