// SPDX-License-Identifier: GPL-3.0-or-later
// The curve of one site.
#pragma once
#include <memory>

#include "core/stiffness_map.hpp"
#include "fem/press.hpp"
#include "fem/published.hpp"
#include "stiffness/patch.hpp"

namespace palpate::stiffness {

struct SiteCurve {
  std::vector<double> travel;  ///< [mm] one per load; empty where a load did not converge
  std::vector<double> sunk;    ///< [mm] loads x dent rings: mean way down of the skin there
  SolveMethod method = SolveMethod::none;
  bool bent = false;   ///< the skin under the tool is no height field; the patch is bounded there
  int iterations = 0;  ///< Newton steps over all loads
  int projections = 0;
  double residual = 0;                          ///< [N] of the last load tried
  std::vector<fem::PublishedSample> published;  ///< the recipe's: loads up to the first bad
};
struct Tool {
  double radius = 8;   ///< [mm] of the sphere
  double penalty = 5;  ///< [MPa/mm] fem::default_penalty
};
/// A tool that is pressed harder goes deeper; an equilibrium on another branch is no curve.
[[nodiscard]] bool deepens(std::span<const double> travel);

/// Sphere from first geometric contact down the patch's axis.
/// @param forces    [N] ascending
/// @param cholesky  analysed for the template's topology; one per thread
[[nodiscard]] SiteCurve press_site(const PatchTemplate& t, const std::vector<Vec3>& nodes,
                                   fem::TissueLaws laws, const Tool& tool,
                                   std::span<const double> forces, fem::Cholesky& cholesky);

/// The same on any body: the site at the origin, +z outward.
/// @param rings  groups of nodes whose way down is noted
[[nodiscard]] SiteCurve press_body(const fem::Topology& topology, const std::vector<Vec3>& nodes,
                                   fem::TissueLaws laws, const Tool& tool,
                                   std::span<const double> forces,
                                   const std::vector<std::vector<std::int32_t>>& rings,
                                   fem::Cholesky& cholesky);

/// Corner nodes of the skin ring by ring, the middle first: where dents are measured.
[[nodiscard]] std::vector<std::vector<std::int32_t>> skin_rings(const PatchTemplate& t);

}  // namespace palpate::stiffness
