// SPDX-License-Identifier: GPL-3.0-or-later
// Full solves at many sites: batches of sixteen in single precision, stragglers in double.
#pragma once
#include "stiffness/ground.hpp"
#include "stiffness/site.hpp"

namespace palpate::stiffness {

struct PressedSites {
  std::vector<SiteCurve> curves;  ///< one per site, in order
  int clamped = 0;                ///< sites whose skin under the tool is no height field
  int in_double = 0;              ///< sites that single precision did not bring to an equilibrium
};
/// @param sites  points of the skin with bone beneath
/// @param depth  [mm] one per point of the skin
/// @note A site's curve depends on no other site, nor on the number of threads.
[[nodiscard]] PressedSites press_sites(const Ground& ground, std::span<const std::int32_t> sites,
                                       std::span<const double> depth, const Progress& progress,
                                       double from, double to);

/// The template that a depth asks for: two layers, or three where tissue is thick.
[[nodiscard]] PatchRule rule_for_depth(double depth, double tool_radius);

}  // namespace palpate::stiffness
