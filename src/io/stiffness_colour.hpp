// SPDX-License-Identifier: Apache-2.0
// The heat map: secant stiffness at one force as a colour per vertex.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/stiffness_map.hpp"

namespace palpate::io {

inline constexpr double kColourForce = 2.0;  ///< [N] the force at which regions are compared

/// Force over travel [N/mm] at `force` [N], travel interpolated between the samples (and 0 at 0 N);
/// beyond the last sample, that one's. NaN where the vertex has no curve.
[[nodiscard]] double secant_stiffness(const StiffnessMap& map, std::size_t vertex, double force);

using Rgb = std::array<std::uint8_t, 3>;  ///< sRGB

struct StiffnessColours {
  double low = 0, high = 0;  ///< [N/mm] ends of the logarithmic scale: 2nd and 98th percentile
  std::vector<Rgb> colour;   ///< one per vertex; grey where there is no curve
};
/// viridis over the logarithm of secant_stiffness at kColourForce.
[[nodiscard]] StiffnessColours stiffness_colours(const StiffnessMap& map);

/// sRGB byte to linear light in [0, 1] (IEC 61966-2-1), which glTF stores.
[[nodiscard]] double linear_light(std::uint8_t srgb);

}  // namespace palpate::io
