// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of means assume, shown beside them: normal values, alike spreads.
#pragma once
#include <span>
#include <vector>

namespace palpate::study::statistics {

struct ShapiroWilk {
  double w = 0;  ///< 1 for perfectly normal spacings; NaN for n < 3, n > 5000 or no spread
  double p = 0;
};
/// Are the values normal? A small p says no. NaN values are left out. With many ties (ratings) it
/// answers "no" more readily than the t test minds.
/// @cite Shapiro & Wilk 1965, "An analysis of variance test for normality"; weights and p after
/// Royston 1995, "A remark on Algorithm AS 181: the W-test for normality" (AS R94)
[[nodiscard]] ShapiroWilk shapiro_wilk(std::span<const double> values);

struct SpreadTest {
  double f = 0;  ///< NaN where a group has fewer than two values or none has spread
  double p = 0;
  double ratio = 0;  ///< larger variance over smaller; NaN where one is zero
};
/// Are the spreads of two groups alike? Analysis of variance of |value - median of its group|.
/// @cite Brown & Forsythe 1974, "Robust tests for the equality of variances"
[[nodiscard]] SpreadTest brown_forsythe(std::span<const double> a, std::span<const double> b);

}  // namespace palpate::study::statistics
