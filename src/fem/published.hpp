// SPDX-License-Identifier: GPL-3.0-or-later
// The published recipe for one point: a force on one node, Saint-Venant-Kirchhoff tissue, dynamics
// stepped to rest. It runs here as it was described, so that a reader can see what it does.
#pragma once
#include "fem/dynamics.hpp"
#include "fem/elastic_body.hpp"

namespace palpate::fem {

/// Thesis, Table 4.2; the figures of the dynamics are ours (dynamics.hpp).
struct PublishedRecipe {
  double flesh_youngs_modulus = 0.045658;  ///< [MPa]
  double flesh_poissons_ratio = 0.43;
  double flesh_density = 1.060e-9;     ///< [N s^2/mm^4], 1060 kg/m^3
  double bone_youngs_modulus = 6.0e3;  ///< [MPa]
  double bone_poissons_ratio = 0.22;
  double bone_density = 1.421e-9;     ///< [N s^2/mm^4], 1421 kg/m^3
  double compression_resistance = 0;  ///< st_venant_kirchhoff()'s; the source had none
  DynamicsOptions dynamics;
};
/// What the recipe says at one force, and whether it can be believed.
struct PublishedSample {
  double displacement = 0;  ///< [mm] of the loaded node along the push
  bool at_rest = false;     ///< the motion settled
  int inverted_tets = 0;    ///< elements turned inside out; > 0: the displacement means nothing
  int steps = 0;
};

/// Each force in a simulation of its own from the undeformed state, as the source did.
/// @param topology  linear, without travel; its held nodes are bone and what organs carry
/// @param nodes     rest positions [mm]
/// @param is_bone   one per tet, non-zero for bone; empty: flesh throughout
/// @param node      that is pushed, free
/// @param push      [-] direction, the inward normal
/// @param forces    [N] > 0
/// @param cholesky  analysed for the topology; one per thread
/// @throws InputError  the node is held or out of range, the mesh is quadratic
/// @note A sample that did not settle or is inverted is returned and marked; it does not throw.
///       Deterministic, re-entrant, allocates.
[[nodiscard]] std::vector<PublishedSample> press_published(
    const Topology& topology, const std::vector<Vec3>& nodes, std::span<const std::uint8_t> is_bone,
    std::int32_t node, const Vec3& push, std::span<const double> forces, Cholesky& cholesky,
    const PublishedRecipe& recipe = {});

}  // namespace palpate::fem
