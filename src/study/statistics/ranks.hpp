// SPDX-License-Identifier: GPL-3.0-or-later
// Tests by ranks, two-sided. Which form gave p is part of the result and of every table:
//   exact   all arrangements of the ranks counted; only without ties and for small samples
//   normal  normal approximation, its variance corrected for ties, 1/2 taken off for continuity
#pragma once
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace palpate::study::statistics {

enum class RankForm { none, exact, normal };
/// "exact"; "normal approximation, corrected for ties and continuity"; "no test".
[[nodiscard]] std::string_view words(RankForm form);

/// Largest sample for which the arrangements are counted (each sample of Mann-Whitney; the
/// differences of Wilcoxon that are not zero). Above, the approximation is closer than 1e-3 in p.
inline constexpr std::size_t kLargestExactSample = 49;

struct MannWhitney {
  double u = 0;              ///< of a: pairs in which a is larger, ties counting 1/2
  double p = 0;              ///< two-sided; NaN where a sample is empty or all values are equal
  double z = 0;              ///< NaN in the exact form
  double rank_biserial = 0;  ///< 2u/(na nb) - 1: 1 where every a is above every b
  RankForm form = RankForm::none;
  bool ties = false;
};
/// Do a and b come from one distribution? NaN values are left out.
/// @cite Mann & Whitney 1947, "On a test of whether one of two random variables is stochastically
/// larger than the other"
[[nodiscard]] MannWhitney mann_whitney(std::span<const double> a, std::span<const double> b);

struct Wilcoxon {
  double w_plus = 0, w_minus = 0;  ///< sums of the ranks of positive and of negative differences
  double p = 0;                    ///< two-sided; NaN where no difference is left
  double z = 0;                    ///< NaN in the exact form
  double rank_biserial = 0;        ///< (w_plus - w_minus) / (w_plus + w_minus)
  std::size_t n = 0;               ///< differences that are not zero
  std::size_t zeros = 0;           ///< left out before ranking, as Wilcoxon did
  RankForm form = RankForm::none;
  bool ties = false;
};
/// Are the differences symmetric about 0? Signed ranks of |d|; zero differences are dropped.
/// @cite Wilcoxon 1945, "Individual comparisons by ranking methods"
[[nodiscard]] Wilcoxon wilcoxon_signed_rank(std::span<const double> differences);

/// Ranks from 1; equal values share the mean of their ranks. Values must be numbers.
struct Ranks {
  std::vector<double> rank;
  double tie_cubes = 0;  ///< sum over groups of equal values of t^3 - t
};
[[nodiscard]] Ranks mid_ranks(std::span<const double> values);

}  // namespace palpate::study::statistics
