// SPDX-License-Identifier: GPL-3.0-or-later
// Many tests of one question: the chance of any false alarm among them is held.
#pragma once
#include <span>
#include <vector>

namespace palpate::study::statistics {

/// Adjusted p values in the order given; compare each with the level. Holds the family-wise error
/// whatever the dependence. NaN (no test) stays NaN and does not count.
/// @cite Holm 1979, "A simple sequentially rejective multiple test procedure"
[[nodiscard]] std::vector<double> holm(std::span<const double> p);

}  // namespace palpate::study::statistics
