// SPDX-License-Identifier: GPL-3.0-or-later
// The curve of one site.
#pragma once
#include <memory>

#include "fem/press.hpp"
#include "stiffness/patch.hpp"

namespace palpate::stiffness {

struct SiteCurve {
  std::vector<double> travel;  ///< [mm] one per load; empty where a load did not converge
  int iterations = 0;          ///< Newton steps over all loads
  int projections = 0;
  double residual = 0;  ///< [N] of the last load tried
};
struct Tool {
  double radius = 8;   ///< [mm] of the sphere
  double penalty = 5;  ///< [MPa/mm] fem::default_penalty
};
/// Sphere from first geometric contact down the patch's axis.
/// @param forces    [N] ascending
/// @param cholesky  analysed for the template's topology; one per thread
[[nodiscard]] SiteCurve press_site(const PatchTemplate& t, const std::vector<Vec3>& nodes,
                                   std::shared_ptr<const fem::EnergyDensity> law, const Tool& tool,
                                   std::span<const double> forces, fem::Cholesky& cholesky);

}  // namespace palpate::stiffness
