// SPDX-License-Identifier: Apache-2.0
// Palette: viridis (S. van der Walt and N. Smith 2015, CC0), ten of its colours, linear between.
#include "io/stiffness_colour.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::io {

double secant_stiffness(const StiffnessMap& map, std::size_t vertex, double force) {
  if (!map.has_curve(vertex) || map.forces.empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::span<const double> u = map.curve(vertex);
  const auto above = std::lower_bound(map.forces.begin(), map.forces.end(), force);
  if (above == map.forces.end()) return map.forces.back() / u.back();
  const auto i = static_cast<std::size_t>(above - map.forces.begin());
  const double f0 = i == 0 ? 0 : map.forces[i - 1], u0 = i == 0 ? 0 : u[i - 1];
  const double travel = u0 + (u[i] - u0) * (force - f0) / (map.forces[i] - f0);
  return force / travel;
}

static Rgb viridis(double t) {
  static constexpr Rgb kKnots[] = {{0x44, 0x01, 0x54}, {0x48, 0x28, 0x78}, {0x3e, 0x49, 0x89},
                                   {0x31, 0x68, 0x8e}, {0x26, 0x82, 0x8e}, {0x1f, 0x9e, 0x89},
                                   {0x35, 0xb7, 0x79}, {0x6e, 0xce, 0x58}, {0xb5, 0xde, 0x2b},
                                   {0xfd, 0xe7, 0x25}};
  const double at = std::clamp(t, 0.0, 1.0) * 9;
  const int i = std::min(static_cast<int>(at), 8);
  Rgb out;
  for (int c = 0; c < 3; ++c)
    out[c] = static_cast<std::uint8_t>(
        std::lround(kKnots[i][c] + (at - i) * (kKnots[i + 1][c] - kKnots[i][c])));
  return out;
}

StiffnessColours stiffness_colours(const StiffnessMap& map) {
  constexpr Rgb kNoCurve = {0xa0, 0xa0, 0xa0};
  std::vector<double> logs(map.size()), known;
  for (std::size_t v = 0; v < map.size(); ++v) {
    logs[v] = std::log(secant_stiffness(map, v, kColourForce));
    if (std::isfinite(logs[v])) known.push_back(logs[v]);
  }
  StiffnessColours out;
  out.colour.assign(map.size(), kNoCurve);
  if (known.empty()) return out;
  std::sort(known.begin(), known.end());
  const double low = known[known.size() / 50], high = known[known.size() - 1 - known.size() / 50];
  out.low = std::exp(low);
  out.high = std::exp(high);
  for (std::size_t v = 0; v < map.size(); ++v)
    if (std::isfinite(logs[v]))
      out.colour[v] = viridis(high > low ? (logs[v] - low) / (high - low) : 0.5);
  return out;
}

double linear_light(std::uint8_t srgb) {
  const double c = srgb / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

}  // namespace palpate::io
