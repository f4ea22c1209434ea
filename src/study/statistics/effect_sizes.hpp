// SPDX-License-Identifier: GPL-3.0-or-later
// How large a difference is, in standard deviations. Rank-biserial correlations are with the tests
// by ranks. NaN where the spread is zero or a sample has fewer than two values.
#pragma once
#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {

/// (mean of a - mean of b) / pooled sd. @cite Cohen 1988, "Statistical Power Analysis"
[[nodiscard]] double cohen_d(const Moments& a, const Moments& b);
/// Cohen's d without its bias in small samples (exact factor, by gamma functions).
/// @cite Hedges 1981, "Distribution theory for Glass's estimator of effect size"
[[nodiscard]] double hedges_g(const Moments& a, const Moments& b);
/// (mean - reference) / sd: of one sample, or d_z of paired differences with reference 0.
[[nodiscard]] double standardised_mean(const Moments& sample, double reference = 0);

}  // namespace palpate::study::statistics
