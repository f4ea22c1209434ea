// SPDX-License-Identifier: GPL-3.0-or-later
// Number, mean and spread of a sample: what most tests of means need, and what papers print.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace palpate::study::statistics {

struct Interval {
  double low = 0, high = 0;
};

struct Moments {
  std::size_t n = 0;
  double mean = 0;  ///< NaN for n = 0
  double sd = 0;    ///< with n - 1; NaN for n < 2
};

/// Two passes: the mean, then the squares about it. NaN values are left out.
[[nodiscard]] Moments moments(std::span<const double> values);

/// Moments of the union of disjoint groups from theirs alone, exactly: the published tables can be
/// checked without the raw ratings. A group of n = 0 adds nothing; one of n = 1 has no sd to use.
[[nodiscard]] Moments combined(std::span<const Moments> groups);

/// Interval of the mean by Student's t; NaN for n < 2.
[[nodiscard]] Interval mean_interval(const Moments& sample, double confidence = 0.95);

/// q-quantile with linear interpolation between the sorted values (Hyndman and Fan's type 7, the
/// default of R and NumPy); NaN for none.
[[nodiscard]] double quantile(std::span<const double> values, double q);
[[nodiscard]] double median(std::span<const double> values);

/// The values that are numbers, in their order.
[[nodiscard]] std::vector<double> numbers(std::span<const double> values);

}  // namespace palpate::study::statistics
