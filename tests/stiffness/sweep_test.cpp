// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scenes.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/survey.hpp"

namespace palpate::stiffness {
namespace {

SweepOptions quick() {
  SweepOptions o;
  o.mode = SweepMode::exact;
  o.loads = 3;
  o.sites = 16;
  return o;
}

TEST(Sweep, GivesEveryPointOnTissueAnAscendingCurve) {
  scenes::Head head = scenes::head();
  head.skin.region[0] = SkinRegion::nose;
  head.skin.region[1] = SkinRegion::ear;
  SweepOptions o = quick();
  o.organs.organs = Organs::held;
  const Sweep s = sweep(head.skin, head.skull, o);
  EXPECT_EQ(s.map.status[0], VertexStatus::held);
  EXPECT_EQ(s.map.status[1], VertexStatus::no_bone);
  EXPECT_EQ(s.sites.size(), 16u);
  EXPECT_EQ(s.statistics.at("sites_failed"), 0);
  for (std::size_t p = 2; p < s.map.size(); ++p) {
    ASSERT_TRUE(s.map.has_curve(p));
    EXPECT_GT(s.map.error[p], 0);
    EXPECT_GT(s.map.curve(p)[0], 0);
    for (std::size_t l = 1; l < s.map.forces.size(); ++l)
      EXPECT_GT(s.map.curve(p)[l], s.map.curve(p)[l - 1]);
  }
  for (const auto p : s.sites) EXPECT_EQ(s.map.status[p], VertexStatus::solved);
  // What is known before anything is pressed is what the map says afterwards.
  const StiffnessMap before =
      survey(head.skin, head.skull, {head.skin.skin.points, head.skin.region}, o);
  ASSERT_EQ(before.depth.size(), s.map.size());
  EXPECT_TRUE(before.forces.empty());
  for (std::size_t p = 0; p < s.map.size(); ++p) {
    EXPECT_TRUE(before.depth[p] == s.map.depth[p] ||
                (std::isnan(before.depth[p]) && std::isnan(s.map.depth[p])));
    EXPECT_EQ(before.has_curve(p), s.map.has_curve(p)) << "no site failed here";
  }
}

TEST(Sweep, FastModeAdmitsWhereThePatchCannotFollowTheSkin) {
  scenes::Head head = scenes::head(3);
  const std::size_t spike = 0;
  head.skin.skin.points[spike] *= 1.25;        // some 20 mm out of the skin around it, as an ear
  head.skin.region[spike] = SkinRegion::nose;  // held: not pressed itself
  const Vec3 tip = head.skin.skin.points[spike];
  SweepOptions o = quick();
  o.mode = SweepMode::fast;
  o.organs.organs = Organs::held;
  o.loads = 1;
  const Sweep s = sweep(head.skin, head.skull, o);
  int beside = 0;
  for (std::size_t p = 0; p < s.map.size(); ++p) {
    const double away = (head.skin.skin.points[p] - tip).norm();
    if (!s.map.has_curve(p) || p == spike) continue;
    if (away < 30) beside += s.map.error[p] >= 0.2;
    if (away > 60) EXPECT_LT(s.map.error[p], 0.2) << p;
  }
  EXPECT_GT(beside, 0);
}

TEST(Sweep, IsTheSameBitsOnOneAndTwoThreads) {
  const scenes::Head head = scenes::head(3);
  SweepOptions one = quick(), two = quick();
  one.sites = two.sites = 32;
  one.loads = two.loads = 2;
  one.threads = 1;
  two.threads = 2;
  const Sweep a = sweep(head.skin, head.skull, one), b = sweep(head.skin, head.skull, two);
  EXPECT_EQ(a.map.displacement, b.map.displacement);
  EXPECT_EQ(a.map.error, b.map.error);
  EXPECT_EQ(a.sites, b.sites);
}

/// Curves of a few points pressed in full.
std::vector<SiteCurve> press_points(const scenes::Head& head,
                                    const std::vector<std::int32_t>& points) {
  const SweepOptions o = quick();
  SkinPoints at;
  for (const std::int32_t p : points) {
    at.position.push_back(head.skin.skin.points[p]);
    at.region.push_back(SkinRegion::cheek);
  }
  const Ground ground(head.skin, head.skull, at, o, {});
  Checkpoint store;
  std::vector<std::int32_t> spots(points.size());
  std::iota(spots.begin(), spots.end(), 0);
  press_sites(ground, SolveLevel::full, spots, {}, store, {}, 0, 1);
  std::vector<SiteCurve> curves;
  for (const std::int32_t s : spots) curves.push_back(*store.find(SolveLevel::full, s));
  return curves;
}

// The template turns with the head's axes and its diagonals are not symmetric: what is left is the
// discretisation, a fraction of the stated error.
TEST(Sweep, CurvesDoNotFeelARotationOrAMirror) {
  const scenes::Head head = scenes::head();
  const std::vector<std::int32_t> points = {5, 100, 700, 1500};
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const auto reference = press_points(head, points);
  for (const Mat3& m : {turn, mirror}) {
    const auto moved = press_points(scenes::mapped(head, m), points);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t l = 0; l < 3; ++l)
        EXPECT_NEAR(moved[i].travel.at(l) / reference[i].travel.at(l), 1, 0.01);
  }
}

TEST(Sweep, DeeperTissueIsSofterAndMarkedByItsDepth) {
  const scenes::Head head = scenes::head();
  const Sweep s = sweep(head.skin, head.skull, quick());
  std::vector<std::size_t> order(s.map.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return s.map.depth[a] < s.map.depth[b]; });
  const std::size_t thin = order[order.size() / 20], thick = order[order.size() * 19 / 20];
  EXPECT_GT(s.map.depth[thick], s.map.depth[thin] + 3);
  EXPECT_GT(s.map.curve(thick)[2], 1.2 * s.map.curve(thin)[2]);
}

TEST(Sweep, NoBoneWithinReachGivesNoCurve) {
  scenes::Head head = scenes::head(3);
  for (Vec3& p : head.skull.mesh.points) p = 0.5 * p + Vec3(0, 45, 0);  // a small skull, up high
  SweepOptions o = quick();
  o.loads = 1;
  const Sweep s = sweep(head.skin, head.skull, o);
  EXPECT_GT(s.statistics.at("points_no_bone"), 0.3 * static_cast<double>(s.map.size()));
  for (std::size_t p = 0; p < s.map.size(); ++p)
    if (s.map.status[p] == VertexStatus::no_bone) EXPECT_TRUE(std::isnan(s.map.curve(p)[0]));
}

TEST(Sweep, RefusesWhatItCannotPress) {
  const scenes::Head head = scenes::head(2);
  SweepOptions o = quick();
  o.tool_radius = 500;
  EXPECT_THROW((void)sweep(head.skin, head.skull, o), InputError);
  o = quick();
  o.tissue.poissons_ratio = 0.5;
  EXPECT_THROW((void)sweep(head.skin, head.skull, o), InputError);
  EXPECT_THROW((void)sweep({}, head.skull, quick()), InputError);
  EXPECT_THROW((void)sweep(head.skin, {}, quick()), InputError);
}

TEST(Sweep, StopsWhenAsked) {
  const scenes::Head head = scenes::head(3);
  std::atomic<bool> stop = true;
  EXPECT_THROW((void)sweep(head.skin, head.skull, quick(), Progress({}, &stop)), Cancelled);
}

}  // namespace
}  // namespace palpate::stiffness
