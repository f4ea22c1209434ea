// SPDX-License-Identifier: GPL-3.0-or-later
// Identities, closed forms and ends of the statistics; the numbers are in statistics_table_test.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.hpp"
#include "study/statistics/assumptions.hpp"
#include "study/statistics/correlation.hpp"
#include "study/statistics/effect_sizes.hpp"
#include "study/statistics/kendall.hpp"
#include "study/statistics/multiple_testing.hpp"
#include "study/statistics/proportions.hpp"
#include "study/statistics/psychometric.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/t_tests.hpp"

namespace palpate::study::statistics {
namespace {

using Values = std::vector<double>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Moments, CombineToThoseOfTheUnion) {
  const Values a = {1, 4, 2, 8}, b = {5, 7}, c = {1e3};
  Values all = a;
  all.insert(all.end(), b.begin(), b.end());
  all.insert(all.end(), c.begin(), c.end());
  const Moments whole = moments(all);
  const Moments sum = combined(std::array{moments(a), moments(b), moments(c), moments(Values{})});
  EXPECT_EQ(sum.n, whole.n);
  EXPECT_NEAR(sum.mean, whole.mean, 1e-12 * whole.mean);
  EXPECT_NEAR(sum.sd, whole.sd, 1e-12 * whole.sd);
}

TEST(Moments, FarFromZeroKeepTheirDigits) {
  EXPECT_NEAR(moments(Values{1e9 + 1, 1e9 + 2, 1e9 + 3}).sd, 1, 1e-9);
  EXPECT_EQ(moments(Values{kNan, 2, kNan, 4}).n, 2U);
  EXPECT_TRUE(std::isnan(moments(Values{3}).sd));
  EXPECT_TRUE(std::isnan(moments(Values{}).mean));
  EXPECT_TRUE(std::isnan(median(Values{})));
}

TEST(TTests, WithoutAnAnswerSayNotANumber) {
  for (const TTest& t :
       {one_sample_t(moments(Values{3}), 0), one_sample_t(moments(Values{3, 3}), 1),
        welch_t(moments(Values{3}), moments(Values{1, 2})),
        welch_t(moments(Values{3, 3}), moments(Values{1, 1})), paired_t(Values{}, Values{})}) {
    EXPECT_TRUE(std::isnan(t.t));
    EXPECT_TRUE(std::isnan(t.p));
    EXPECT_TRUE(std::isnan(t.interval.low));
  }
  EXPECT_THROW((void)paired_t(Values{1}, Values{1, 2}), InputError);
  EXPECT_EQ(one_sample_t(moments(Values{3, 3}), 1).difference, 2);
}

TEST(TTests, TheIntervalEndsWhereThePIsTheLevel) {
  const Moments a = moments(Values{1, 2, 4, 7, 9}), b = moments(Values{2, 2, 3, 1});
  const TTest t = welch_t(a, b);
  Moments shifted = b;
  shifted.mean += t.interval.low;
  EXPECT_NEAR(welch_t(a, shifted).p, 0.05, 1e-12);
  EXPECT_NEAR(one_sample_t(a, one_sample_t(a, 0).interval.high).p, 0.05, 1e-12);
}

TEST(TTests, SwappedGroupsTurnTheSignOnly) {
  const Moments a = moments(Values{1, 2, 4, 7, 9}), b = moments(Values{2, 2, 3, 1});
  EXPECT_EQ(welch_t(a, b).t, -welch_t(b, a).t);
  EXPECT_EQ(welch_t(a, b).p, welch_t(b, a).p);
}

TEST(MannWhitney, ClosedForms) {
  // All of a above all of b: 2 of the C(7,3) = 35 arrangements are as extreme.
  const MannWhitney m = mann_whitney(Values{5, 6, 7}, Values{1, 2, 3, 4});
  EXPECT_EQ(m.form, RankForm::exact);
  EXPECT_EQ(m.u, 12);
  EXPECT_EQ(m.rank_biserial, 1);
  EXPECT_DOUBLE_EQ(m.p, 2.0 / 35);
  EXPECT_EQ(mann_whitney(Values{1, 1}, Values{1, 1, 1}).form, RankForm::none);
  EXPECT_TRUE(std::isnan(mann_whitney(Values{1, 1}, Values{1, 1, 1}).p));
  EXPECT_TRUE(std::isnan(mann_whitney(Values{}, Values{1}).p));
}

TEST(MannWhitney, FormsMeetAtTheLimit) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Values a, b;
  for (int i = 0; i < 49; ++i) a.push_back(normal(random)), b.push_back(normal(random) + 0.3);
  const MannWhitney exact = mann_whitney(a, b);
  ASSERT_EQ(exact.form, RankForm::exact);
  const double mean = 0.5 * 49 * 49, sd = std::sqrt(49 * 49 / 12.0 * 99);
  const double z = (std::abs(exact.u - mean) - 0.5) / sd;
  EXPECT_NEAR(exact.p, std::erfc(z / std::sqrt(2.0)), 1e-3);
}

TEST(Wilcoxon, ClosedForms) {
  // Five positive differences: 2 of the 32 sign patterns.
  const Wilcoxon w = wilcoxon_signed_rank(Values{1, 2, 3, 0, 4, 5});
  EXPECT_EQ(w.form, RankForm::exact);
  EXPECT_EQ(w.zeros, 1U);
  EXPECT_EQ(w.w_plus, 15);
  EXPECT_EQ(w.rank_biserial, 1);
  EXPECT_DOUBLE_EQ(w.p, 2.0 / 32);
  EXPECT_TRUE(std::isnan(wilcoxon_signed_rank(Values{0, 0}).p));
  EXPECT_EQ(wilcoxon_signed_rank(Values{1, 1, 2}).form, RankForm::normal);
}

TEST(Ranks, OfAnyRisingFunctionAreTheSame) {
  const Values x = {3, 1, 4, 1, 5, 9, 2, 6}, y = {2, 7, 1, 8, 2, 8, 1, 8};
  Values ex, ey;
  for (const double v : x) ex.push_back(std::exp(v));
  for (const double v : y) ey.push_back(v * v * v);
  EXPECT_EQ(kendall(x, y).tau_b, kendall(ex, ey).tau_b);
  EXPECT_EQ(spearman(x, y).r, spearman(ex, ey).r);
}

TEST(Kendall, AllOrdersOfFourCounted) {
  // 24 orders of 4; how many have so few inversions: 1, 4, 9.
  const Values order = {1, 2, 3, 4};
  EXPECT_DOUBLE_EQ(kendall(order, Values{1, 2, 3, 4}).p, 2.0 / 24);
  EXPECT_DOUBLE_EQ(kendall(order, Values{2, 1, 3, 4}).p, 8.0 / 24);
  EXPECT_DOUBLE_EQ(kendall(order, Values{2, 1, 4, 3}).p, 18.0 / 24);
  EXPECT_EQ(kendall(order, Values{4, 3, 2, 1}).tau_b, -1);
  EXPECT_TRUE(std::isnan(kendall(order, Values{1, 1, 1, 1}).tau_b));
  EXPECT_THROW((void)kendall(order, Values{1}), InputError);
}

TEST(PairAccuracy, IsHalfOfOnePlusTauWithoutTies) {
  const Values order = {7, 6, 5, 4, 3, 2, 1}, rated = {9, 10, 6, 7, 1, 3, 2};
  EXPECT_DOUBLE_EQ(pair_accuracy(rated, order), 0.5 * (1 + kendall(rated, order).tau_b));
  EXPECT_EQ(pair_accuracy(Values{5, 5, 5}, Values{1, 2, 3}), 1);  // ties count as right
  EXPECT_TRUE(std::isnan(pair_accuracy(Values{1, 2}, Values{1, 1})));
}

TEST(Proportion, IntervalsHoldTheShareAndReachTheEnds) {
  for (std::size_t n = 1; n < 30; ++n)
    for (std::size_t k = 0; k <= n; ++k) {
      const Proportion p = proportion(k, n);
      EXPECT_LE(p.clopper_pearson.low, p.share);
      EXPECT_GE(p.clopper_pearson.high, p.share);
      EXPECT_LE(p.wilson.low, p.share + 1e-15);
      EXPECT_GE(p.wilson.high, p.share - 1e-15);
    }
  EXPECT_EQ(proportion(0, 25).wilson.low, 0);
  EXPECT_EQ(proportion(25, 25).clopper_pearson.high, 1);
  EXPECT_NEAR(proportion(0, 25).clopper_pearson.high, 1 - std::pow(0.025, 1.0 / 25), 1e-12);
  EXPECT_TRUE(std::isnan(proportion(0, 0).share));
  EXPECT_THROW((void)proportion(2, 1), InputError);
}

TEST(Holm, IsBetweenEachPAndBonferroni) {
  const Values p = {0.01, 0.04, kNan, 0.03, 0.005};
  const Values adjusted = holm(p);
  EXPECT_DOUBLE_EQ(adjusted[4], 0.02);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.03);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[1], 0.06);  // not below that of a smaller p
  EXPECT_TRUE(std::isnan(adjusted[2]));
}

TEST(EffectSizes, DoNotDependOnTheUnit) {
  const Values a = {1, 2, 4, 7, 9}, b = {2, 2, 3, 1};
  Values a10, b10;
  for (const double v : a) a10.push_back(10 * v + 3);
  for (const double v : b) b10.push_back(10 * v + 3);
  EXPECT_NEAR(hedges_g(moments(a), moments(b)), hedges_g(moments(a10), moments(b10)), 1e-14);
  EXPECT_LT(std::abs(hedges_g(moments(a), moments(b))), std::abs(cohen_d(moments(a), moments(b))));
  EXPECT_TRUE(std::isnan(cohen_d(moments(Values{1}), moments(b))));
}

TEST(Assumptions, TellNormalFromNot) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Values bell, skewed;
  for (int i = 0; i < 60; ++i)
    bell.push_back(normal(random)), skewed.push_back(std::exp(2 * bell.back()));
  EXPECT_GT(shapiro_wilk(bell).p, 0.05);
  EXPECT_LT(shapiro_wilk(skewed).p, 1e-6);
  EXPECT_LT(brown_forsythe(bell, skewed).p, 0.05);
  EXPECT_TRUE(std::isnan(shapiro_wilk(Values{1, 1, 1}).w));
  EXPECT_TRUE(std::isnan(brown_forsythe(Values{1}, bell).f));
}

std::vector<ForcedChoice> choices_of(double weber, double lapse, int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> chance(0, 1), level(0.02, 0.6);
  std::vector<ForcedChoice> out;
  for (int i = 0; i < n; ++i) {
    const double x = level(random);
    out.push_back({x, chance(random) < share_correct(x, weber, lapse)});
  }
  return out;
}

TEST(WeberFraction, IsFoundAgainAndItsIntervalHoldsIt) {
  int held = 0;
  const int runs = 200;
  for (int i = 0; i < runs; ++i) {
    const PsychometricFit fit = fit_weber_fraction(
        choices_of(0.15, 0.02, 80, static_cast<std::uint64_t>(i)), {.check_shape = false});
    held += fit.interval.low <= 0.15 && 0.15 <= fit.interval.high;
  }
  // 95 % nominal: 190 expected, 180 is three standard deviations off.
  EXPECT_GE(held, 180);
  EXPECT_LE(held, 199);
  const PsychometricFit many = fit_weber_fraction(choices_of(0.15, 0.02, 4000, 1));
  EXPECT_NEAR(many.weber_fraction, 0.15, 0.02);
  EXPECT_NEAR(many.shape, 1, 0.2);
  EXPECT_GT(many.shape_p, 0.001);
}

TEST(WeberFraction, ScalesWithTheLevels) {
  auto choices = choices_of(0.15, 0.02, 80, 5);
  const double once = fit_weber_fraction(choices).weber_fraction;
  for (ForcedChoice& c : choices) c.level *= 2;
  EXPECT_NEAR(fit_weber_fraction(choices).weber_fraction, 2 * once, 1e-9);
}

TEST(WeberFraction, IsNotMadeUpWhereTheChoicesDoNotBoundIt) {
  const std::vector<ForcedChoice> right(20, {0.3, true}), wrong(20, {0.3, false});
  EXPECT_TRUE(std::isnan(fit_weber_fraction(right).weber_fraction));
  EXPECT_EQ(fit_weber_fraction(right).interval.low, 0);
  EXPECT_LT(fit_weber_fraction(right).interval.high, 0.3);
  EXPECT_TRUE(std::isnan(fit_weber_fraction(wrong).weber_fraction));
  EXPECT_TRUE(std::isinf(fit_weber_fraction(wrong).interval.high));
  EXPECT_TRUE(std::isnan(fit_weber_fraction({}).weber_fraction));
  const std::vector<ForcedChoice> bad = {{0.1, true}, {0, true}};
  EXPECT_THROW((void)fit_weber_fraction(bad), InputError);
  EXPECT_THROW((void)fit_weber_fraction(right, {.lapse = 1}), InputError);
}

}  // namespace
}  // namespace palpate::study::statistics
