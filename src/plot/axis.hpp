// SPDX-License-Identifier: GPL-3.0-or-later
// Where the ticks of an axis go.
#pragma once
#include <string>
#include <vector>

namespace palpate::plot {

struct Tick {
  double value = 0;
  std::string text;
};

/// Round values (1, 2 or 5 times a power of ten apart) that cover [low, high]; the first is <= low,
/// the last >= high. About `wanted` of them. Never empty; a degenerate range is widened.
[[nodiscard]] std::vector<Tick> linear_ticks(double low, double high, int wanted = 6);

/// For a logarithmic scale: 1, 2 and 5 times powers of ten inside [low, high] (0 < low < high);
/// where fewer than two fit, the two ends.
[[nodiscard]] std::vector<Tick> log_ticks(double low, double high);

}  // namespace palpate::plot
