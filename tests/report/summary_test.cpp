// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "report/figures_of_map.hpp"
#include "report/verdict.hpp"
#include "scenes.hpp"

namespace palpate::report {
namespace {

using Values = std::vector<double>;

TEST(KendallTau, KnownCases) {
  EXPECT_DOUBLE_EQ(kendall_tau(Values{1, 2, 3, 4}, Values{10, 20, 30, 40}), 1);
  EXPECT_DOUBLE_EQ(kendall_tau(Values{1, 2, 3, 4}, Values{4, 3, 2, 1}), -1);
  // One swapped pair of neighbours among seven: (20 - 1) / 21.
  EXPECT_DOUBLE_EQ(kendall_tau(Values{1, 2, 3, 4, 5, 6, 7}, Values{1, 2, 4, 3, 5, 6, 7}),
                   19.0 / 21);
  // Ties (tau-b): x has one tied pair, y none; concordant 5, discordant 0, sqrt(5 * 6).
  EXPECT_DOUBLE_EQ(kendall_tau(Values{1, 1, 2, 3}, Values{1, 2, 3, 4}), 5 / std::sqrt(30.0));
  EXPECT_TRUE(std::isnan(kendall_tau(Values{1, 1, 1}, Values{1, 2, 3})));
  EXPECT_TRUE(std::isnan(kendall_tau(Values{}, Values{})));
  EXPECT_THROW((void)kendall_tau(Values{1}, Values{}), InputError);
}

TEST(Quantile, LinearBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(median({3, 1, 2}), 2);
  EXPECT_DOUBLE_EQ(median({4, 1, 2, 3}), 2.5);
  EXPECT_DOUBLE_EQ(median({NAN, 5, INFINITY}), 5);
  EXPECT_DOUBLE_EQ(quantile({0, 10}, 0.95), 9.5);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(TravelAt, LinearFromTheOriginThroughTheSamples) {
  StiffnessMap m;
  m.forces = {1, 3};
  m.displacement = {2, 3, NAN, NAN};
  m.status = {VertexStatus::solved, VertexStatus::failed};
  EXPECT_DOUBLE_EQ(travel_at(m, 0, 0.5), 1);
  EXPECT_DOUBLE_EQ(travel_at(m, 0, 2), 2.5);
  EXPECT_DOUBLE_EQ(travel_at(m, 0, 3), 3);
  EXPECT_TRUE(std::isnan(travel_at(m, 0, 3.1)));  // never beyond what was pressed
  EXPECT_TRUE(std::isnan(travel_at(m, 1, 2)));
  EXPECT_DOUBLE_EQ(compared_stiffness(m, 0), 2 / 2.5);
}

TEST(RegionSummary, FindsThePublishedOrderAndItsReverse) {
  const auto head = scenes::ball_head(true);
  const RegionSummary s = region_summary(head);
  ASSERT_EQ(s.order.size(), 7U);
  EXPECT_TRUE(std::equal(s.order.begin(), s.order.end(), kPublishedOrder.begin()));
  EXPECT_DOUBLE_EQ(s.kendall_tau.value(), 1);
  EXPECT_DOUBLE_EQ(region_summary(scenes::ball_head(false)).kendall_tau.value(), -1);
  for (const RegionFigures& f : s.regions) {
    if (f.region == SkinRegion::cranium) {
      EXPECT_DOUBLE_EQ(f.stiffness, 2);  // u = 0.5 f
      EXPECT_DOUBLE_EQ(f.depth, 10);
      EXPECT_DOUBLE_EQ(f.median_u.back(), 1.5);
    }
    if (f.region == SkinRegion::neck) {
      EXPECT_EQ(f.with_curve, 0U);
      EXPECT_TRUE(std::isnan(f.stiffness));
    }
  }
}

TEST(RegionSummary, NumbersOfVerticesAddUp) {
  const auto head = scenes::ball_head();
  std::size_t all = 0;
  for (const RegionFigures& f : region_summary(head).regions) all += f.vertices;
  EXPECT_EQ(all, head.skin.points.size());
}

TEST(RegionSummary, NoTauBelowTwoRegions) {
  auto head = scenes::ball_head();
  for (auto& r : head.map.region) r = SkinRegion::cheek;
  const RegionSummary s = region_summary(head);
  EXPECT_FALSE(s.kendall_tau.has_value());
  EXPECT_TRUE(to_json(s)["kendall_tau"].is_null());
  EXPECT_TRUE(region_summary(TouchableHead{}).order.empty());
}

TEST(RegionSummary, JsonHasNoNan) {
  const std::string text = to_json(region_summary(scenes::ball_head())).dump();
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_NE(text.find("\"stiffness_n_per_mm\":null"), std::string::npos);  // the neck
}

TEST(Verdict, CountsDepthsThatHaveAnSdAndWereReached) {
  const auto head = scenes::ball_head();
  const DepthAgreement a = depth_agreement(head.depths);
  EXPECT_EQ(a.compared, 2U);
  EXPECT_EQ(a.within, 1U);  // z = 0.5 and 1.83
  EXPECT_NEAR(z_score(head.depths[1]), 5.5 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(z_score(head.depths[2])));
  EXPECT_TRUE(std::isnan(z_score(head.depths[3])));
}

TEST(Verdict, AFailedCheckComesFirstAndUnsettlesTheWhole) {
  auto head = scenes::ball_head();
  head.landmarks["eye_outer_left"].confidence = 0.9;
  head.depths = {
      {"a", 5, 1, 5, true}, {"b", 5, 1, 5, true}, {"c", 5, 1, 5, true}, {"d", 5, 1, 9, true}};
  EXPECT_TRUE(judge(head, region_summary(head)).sound);
  head.landmarks["eye_outer_left"].confidence = 0.1;
  const Verdict v = judge(head, region_summary(head));
  EXPECT_FALSE(v.sound);
  EXPECT_NE(v.care.at(0).find("eye outer left"), std::string::npos);
}

}  // namespace
}  // namespace palpate::report
