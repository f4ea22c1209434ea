// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of means by Student's t, all two-sided, each with the interval of the difference.
// Where a test has no answer (fewer than two values, or values without any spread) t, df, p and the
// interval are NaN; `difference` is still given.
#pragma once
#include <span>

#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {

struct TTest {
  double t = 0;
  double df = 0;  ///< degrees of freedom; fractional for Welch
  double p = 0;   ///< two-sided
  double difference = 0;
  Interval interval{};  ///< of the difference
};

/// Is the mean `reference`? difference = mean - reference.
[[nodiscard]] TTest one_sample_t(const Moments& sample, double reference, double confidence = 0.95);

/// Two measurements of the same people: the one-sample test of a[i] - b[i] against 0. Pairs with a
/// NaN are left out. @throws InputError  the spans differ in length
[[nodiscard]] TTest paired_t(std::span<const double> a, std::span<const double> b,
                             double confidence = 0.95);

/// Two groups, spreads not assumed equal; difference = mean of a - mean of b.
/// @cite Welch 1947, "The generalization of Student's problem when several different population
/// variances are involved"; degrees of freedom after Satterthwaite 1946
[[nodiscard]] TTest welch_t(const Moments& a, const Moments& b, double confidence = 0.95);

/// a[i] - b[i] where both are numbers. @throws InputError  the spans differ in length
[[nodiscard]] std::vector<double> differences(std::span<const double> a, std::span<const double> b);

}  // namespace palpate::study::statistics
