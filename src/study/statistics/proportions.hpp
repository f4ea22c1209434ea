// SPDX-License-Identifier: GPL-3.0-or-later
// A share of successes with what the number of trials allows to say about it.
#pragma once
#include <cstddef>

#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {

struct Proportion {
  std::size_t successes = 0, trials = 0;
  double share = 0;            ///< NaN for no trials
  Interval wilson{};           ///< close to the nominal confidence on average
  Interval clopper_pearson{};  ///< never less than the nominal confidence
};
/// @throws InputError  successes > trials
/// @cite Wilson 1927, "Probable inference, the law of succession, and statistical inference" (no
/// continuity correction); Clopper & Pearson 1934, "The use of confidence or fiducial limits"
[[nodiscard]] Proportion proportion(std::size_t successes, std::size_t trials,
                                    double confidence = 0.95);

}  // namespace palpate::study::statistics
