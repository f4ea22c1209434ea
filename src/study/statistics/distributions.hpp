// SPDX-License-Identifier: GPL-3.0-or-later
// Tails and quantiles of the distributions that the tests refer to, by Boost.Math. Tails are
// computed as tails, never as one minus the rest, so that a small p keeps its digits.
#pragma once

namespace palpate::study::statistics {

[[nodiscard]] double normal_lower(double z);         ///< P(Z <= z)
[[nodiscard]] double normal_upper(double z);         ///< P(Z > z)
[[nodiscard]] double normal_two_sided(double z);     ///< P(|Z| > |z|)
[[nodiscard]] double normal_quantile(double share);  ///< 0 < share < 1
[[nodiscard]] double student_two_sided(double t, double df);
[[nodiscard]] double student_quantile(double share, double df);
[[nodiscard]] double fisher_upper(double f, double df_between, double df_within);
[[nodiscard]] double chi_squared_upper(double x, double df);
[[nodiscard]] double chi_squared_quantile(double share, double df);
[[nodiscard]] double beta_quantile(double share, double a, double b);

}  // namespace palpate::study::statistics
