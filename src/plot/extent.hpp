// SPDX-License-Identifier: GPL-3.0-or-later
// The span of the values that a figure shows.
#pragma once
#include <algorithm>
#include <cmath>

namespace palpate::plot {

struct Extent {
  double low = INFINITY, high = -INFINITY;
  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

}  // namespace palpate::plot
