// SPDX-License-Identifier: GPL-3.0-or-later
// Dead loads: forces that keep size and direction while the tissue moves. A smooth patch of
// pressure, or the source's force on one node.
#pragma once
#include <span>
#include <string>

#include "fem/body.hpp"
#include "fem/cholesky.hpp"

namespace palpate::fem {

struct NodalLoad {
  std::int32_t node = 0;
  Vec3 force = Vec3::Zero();  ///< [N]
};

/// 1 N on one node: what the source did. Its displacement grows without bound as the mesh is
/// refined, so that it says something about one mesh only.
[[nodiscard]] std::vector<NodalLoad> nodal_force(std::int32_t node, const Vec3& direction);

/// Pressure ~ 1 - (r/radius)^2 within `radius` of the axis, in all 1 N along the axis: what a
/// finger pad does without asking where it touches. Integrated over the rest area with twelve
/// points a face and scaled so that the resultant is exact on any mesh.
/// @param faces  skin, stride face_nodes(order)
/// @param axis   [-] unit, the direction of the push
/// @throws InputError when no face lies under the patch
[[nodiscard]] std::vector<NodalLoad> pressure_patch(const std::vector<std::int32_t>& faces,
                                                    ElementOrder order,
                                                    const std::vector<Vec3>& nodes,
                                                    const Vec3& centre, const Vec3& axis,
                                                    double radius);

/// The loads as one vector over the unknowns [N]; what falls on held nodes goes into the support.
/// @throws InputError  names a node out of range
[[nodiscard]] Eigen::VectorXd load_vector(const Topology& topology,
                                          std::span<const NodalLoad> loads);

struct LoadUpOptions {
  double relative_tolerance = 1e-6;  ///< [-] largest force left on a node, of the resultant; > 0
  int max_iterations = 60;           ///< Newton steps of one attempt
  double smallest_step = 1.0 / 64;   ///< [-] share of the way to the next factor, then it fails
};
struct LoadedStates {
  std::vector<Eigen::VectorXd> states;  ///< unknowns, one per factor that converged
  int iterations = 0;                   ///< Newton steps over all factors
  int projections = 0;
  double reached = 0;   ///< largest factor at which an equilibrium was found
  std::string failure;  ///< "" when all converged, else the reason
};
/// Stationary points of E(u) - factor * unit . u for ascending factors. A factor that does not
/// converge from the last state is approached in halved steps; where those fail, the rest is left
/// out and `failure` says why.
/// @param body      topology without travel
/// @param unit      load_vector() of a unit load
/// @param cholesky  analysed for the body's topology
[[nodiscard]] LoadedStates load_up(const Body& body, const Eigen::VectorXd& unit,
                                   std::span<const double> factors, Cholesky& cholesky,
                                   const LoadUpOptions& options = {});

}  // namespace palpate::fem
