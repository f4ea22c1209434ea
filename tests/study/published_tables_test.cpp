// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the published study (docs/method/published.md), recomputed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "study/statistics/effect_sizes.hpp"
#include "study/statistics/kendall.hpp"
#include "study/statistics/t_tests.hpp"

namespace palpate::study::statistics {
namespace {

const std::vector<double> kExperienced = {7, 7, 8, 8, 9, 9, 9};
const std::vector<double> kNovice = {7, 7, 8, 8, 8, 8, 9, 9, 9, 9, 9, 9, 9, 9, 10, 10, 10, 10};

std::vector<double> everyone() {
  std::vector<double> all = kExperienced;
  all.insert(all.end(), kNovice.begin(), kNovice.end());
  return all;
}

TEST(PublishedTables, RationalityRatingsAgainstEight) {
  const Moments all = moments(everyone());
  EXPECT_EQ(all.n, 25U);
  EXPECT_NEAR(all.mean, 8.600, 5e-13);
  EXPECT_NEAR(all.sd, 0.957, 5e-4);
  const TTest t = one_sample_t(all, 8.0);
  EXPECT_NEAR(t.t, 3.133, 5e-4);
  EXPECT_EQ(t.df, 24);
  EXPECT_NEAR(t.p, 0.0045, 5e-5);  // two-sided; the thesis prints 0.025
  EXPECT_NEAR(standardised_mean(all, 8.0), 0.627, 5e-4);
  // The groups as the thesis gives them, and no difference between them.
  EXPECT_NEAR(moments(kExperienced).mean, 8.14, 5e-3);
  EXPECT_NEAR(moments(kExperienced).sd, 0.90, 5e-3);
  EXPECT_NEAR(moments(kNovice).mean, 8.78, 5e-3);
  EXPECT_NEAR(moments(kNovice).sd, 0.943, 5e-4);
  EXPECT_GT(welch_t(moments(kExperienced), moments(kNovice)).p, 0.05);
}

struct Row {
  std::string region;
  double mean7, sd7, mean18, sd18, mean25, sd25;
};
constexpr double kHalfDigit = 5e-4;  ///< the tables have three decimals

/// How far rounding of a group's mean and sd can move the total's: at most as far as it moved them,
/// plus the rounding of the total.
constexpr double kRounding = 2 * kHalfDigit + 1e-3;

TEST(PublishedTables, GroupsOfStiffnessRatingsCombineToTheirTotals) {
  const std::array<Row, 6> rows = {{
      {"Cranium", 8.928, 0.886, 8.250, 1.427, 8.440, 1.317},
      {"Forehead", 7.928, 1.367, 8.000, 1.485, 7.980, 1.426},
      {"Eyebrow", 7.428, 1.511, 7.361, 1.616, 7.380, 1.556},
      {"Cheekbone", 5.571, 1.592, 5.389, 1.065, 5.440, 1.202},
      {"Cheek", 1.714, 0.809, 1.806, 0.689, 1.780, 0.708},
      {"Jaw", 5.571, 2.09, 4.806, 1.742, 5.020, 1.834},
  }};
  for (const Row& r : rows) {
    const Moments all =
        combined(std::array{Moments{7, r.mean7, r.sd7}, Moments{18, r.mean18, r.sd18}});
    EXPECT_EQ(all.n, 25U);
    EXPECT_NEAR(all.mean, r.mean25, kRounding) << r.region;
    EXPECT_NEAR(all.sd, r.sd25, kRounding) << r.region;
  }
}

TEST(PublishedTables, ChinLeavesOneNoviceRatingOut) {
  const Moments experienced{7, 2.857, 0.690};
  const Moments printed = combined(std::array{experienced, Moments{18, 2.941, 0.682}});
  EXPECT_GT(std::abs(printed.mean - 2.880), 0.03);  // the printed novice mean does not fit
  // 50/17 = 2.941: the mean of 17 ratings. With the eighteenth, a 2, the mean is 52/18.
  const Moments seventeen{17, 50.0 / 17, 0.682};
  const Moments eighteen = combined(std::array{seventeen, Moments{1, 2, 0}});
  EXPECT_NEAR(eighteen.mean, 2.889, kHalfDigit);
  EXPECT_NEAR(eighteen.sd, 0.698, 1e-3);
  const Moments all = combined(std::array{experienced, eighteen});
  EXPECT_NEAR(all.mean, 2.880, kHalfDigit);
  EXPECT_NEAR(all.sd, 0.681, 1e-3);
}

TEST(PublishedTables, MeanRatingsAreInTheReferenceOrder) {
  // cranium, forehead, eyebrow, cheekbone, jaw, chin, cheek
  const std::array<double, 7> ratings = {8.440, 7.980, 7.380, 5.440, 5.020, 2.880, 1.780};
  const std::array<double, 7> order = {7, 6, 5, 4, 3, 2, 1};
  EXPECT_EQ(pair_accuracy(ratings, order), 1);
  EXPECT_EQ(kendall(ratings, order).tau_b, 1);
  // One of the 21 pairs the wrong way: the 95.3 % that the thesis names is 20/21.
  std::array<double, 7> swapped = ratings;
  std::swap(swapped[0], swapped[1]);
  EXPECT_DOUBLE_EQ(pair_accuracy(swapped, order), 20.0 / 21);
  // A pair rated equal counts as right.
  swapped[0] = swapped[1];
  EXPECT_EQ(pair_accuracy(swapped, order), 1);
}

}  // namespace
}  // namespace palpate::study::statistics
