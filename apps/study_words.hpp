// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a study as words.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "study/statistics/moments.hpp"

namespace palpate::app {

inline std::string fixed(double v, int digits) {
  return std::isfinite(v) ? fmt::format("{:.{}f}", v == 0 ? 0.0 : v, digits) : "–";
}
/// 0.012; below 0.001 "< 0.001"; "–" where no test was possible.
inline std::string p_cell(double p) {
  if (std::isnan(p)) return "–";
  return p < 0.001 ? "< 0.001" : fmt::format("{:.3f}", p);
}
inline std::string p_words(double p) {
  if (std::isnan(p)) return "no test";
  return p < 0.001 ? "p < 0.001" : fmt::format("p = {:.3f}", p);
}
inline std::string interval_cell(const study::statistics::Interval& i, int digits) {
  return std::isnan(i.low) || std::isnan(i.high)
             ? "–"
             : fmt::format("{:.{}f} to {:.{}f}", i.low, digits, i.high, digits);
}
inline std::string spaced(std::string id) {
  std::replace(id.begin(), id.end(), '-', ' ');
  return id;
}

}  // namespace palpate::app
