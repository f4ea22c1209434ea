// SPDX-License-Identifier: GPL-3.0-or-later
// Does one quantity go with another?
#pragma once
#include <span>

#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {

struct Correlation {
  std::size_t n = 0;
  double r = 0;         ///< NaN for n < 3 or where one side has no spread
  double p = 0;         ///< two-sided, by Student's t with n - 2 degrees of freedom
  Interval interval{};  ///< by Fisher's z; NaN for n < 4
};
/// Along a straight line. Pairs with a NaN are left out. @throws InputError  lengths differ
[[nodiscard]] Correlation pearson(std::span<const double> x, std::span<const double> y,
                                  double confidence = 0.95);
/// Along any rising line: Pearson's r of the mid-ranks. Its p by t is an approximation, as is the
/// interval.
[[nodiscard]] Correlation spearman(std::span<const double> x, std::span<const double> y,
                                   double confidence = 0.95);

/// Least-squares line y = intercept + slope x; NaN where x has no spread.
struct Line {
  double intercept = 0, slope = 0;
};
[[nodiscard]] Line fitted_line(std::span<const double> x, std::span<const double> y);

}  // namespace palpate::study::statistics
