// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/svg_writer.hpp"

namespace palpate::plot {

std::vector<Tick> linear_ticks(double low, double high, int wanted) {
  if (!std::isfinite(low) || !std::isfinite(high)) low = 0, high = 1;
  if (high < low) std::swap(low, high);
  const double scale = std::max(std::abs(low), std::abs(high));
  if (high - low <= 1e-9 * scale || high == low) high = low + (scale > 0 ? scale : 1);
  const double rough = (high - low) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double m : {1.0, 2.0, 5.0})
    if (m * power >= rough * (1 - 1e-9)) {
      step = m * power;
      break;
    }
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  const auto first = static_cast<long>(std::floor(low / step + 1e-9));
  const auto last = static_cast<long>(std::ceil(high / step - 1e-9));
  std::vector<Tick> ticks;
  for (long i = first; i <= last; ++i) {
    const double value = static_cast<double>(i) * step;
    ticks.push_back({value, fmt::format("{:.{}f}", value == 0 ? 0.0 : value, decimals)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(double low, double high) {
  std::vector<Tick> ticks;
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = static_cast<int>(std::ceil(std::log10(high)));
  for (int decade = first; decade <= last; ++decade)
    for (const double m : {1.0, 2.0, 5.0}) {
      const double value = m * std::pow(10.0, decade);
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9))
        ticks.push_back({value, number_text(value, 3)});
    }
  if (ticks.size() < 2) ticks = {{low, number_text(low, 2)}, {high, number_text(high, 2)}};
  return ticks;
}

}  // namespace palpate::plot
