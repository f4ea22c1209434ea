// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of two orders of the same things.
#pragma once
#include <cstddef>
#include <span>

#include "study/statistics/ranks.hpp"

namespace palpate::study::statistics {

struct Kendall {
  double tau_b = 0;  ///< -1 reversed, 1 the same; NaN where one side is all ties
  double p = 0;      ///< two-sided, of no association
  double z = 0;      ///< NaN in the exact form
  std::size_t concordant = 0, discordant = 0, tied = 0;  ///< pairs; tied on either side
  /// exact: all orders counted, without ties and up to kLargestExactKendall things; normal: its
  /// variance corrected for ties, no continuity correction.
  RankForm form = RankForm::none;
};
/// Largest number of things whose n! orders are counted.
inline constexpr std::size_t kLargestExactKendall = 33;

/// @throws InputError  the spans differ in length. Pairs with a NaN are left out.
/// @cite Kendall 1945, "The treatment of ties in ranking problems"; Kendall 1970, "Rank Correlation
/// Methods", 4.7 (variance with ties)
[[nodiscard]] Kendall kendall(std::span<const double> a, std::span<const double> b);

/// The measure that the published study calls ranking accuracy: of all pairs that `reference`
/// orders, the share that `ratings` does not put the other way round. A pair rated equal counts as
/// right. NaN where no pair can be compared.
/// @param reference  larger is stiffer; one per thing
/// @throws InputError  the spans differ in length
[[nodiscard]] double pair_accuracy(std::span<const double> ratings,
                                   std::span<const double> reference);

}  // namespace palpate::study::statistics
