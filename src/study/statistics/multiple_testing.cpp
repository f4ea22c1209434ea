// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/multiple_testing.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::study::statistics {

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!std::isnan(p[i])) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return p[i] < p[j]; });
  std::vector<double> adjusted(p.begin(), p.end());
  double floor = 0;  // an adjusted p is never below that of a smaller p
  for (std::size_t k = 0; k < order.size(); ++k) {
    floor = std::max(floor, std::min(1.0, static_cast<double>(order.size() - k) * p[order[k]]));
    adjusted[order[k]] = floor;
  }
  return adjusted;
}

}  // namespace palpate::study::statistics
