// SPDX-License-Identifier: GPL-3.0-or-later
// Static equilibrium: where the tissue rests when some nodes are held and some are pulled.
#pragma once
#include <span>

#include "fem/elastic_body.hpp"
#include "fem/loads.hpp"
#include "fem/tet_mesh.hpp"

namespace palpate::fem {

struct HeldNode {
  std::int32_t node = 0;
  Vec3 displacement = Vec3::Zero();  ///< [mm]
};
struct EquilibriumOptions {
  double force_tolerance = 1e-6;  ///< [N] largest force left on a free node; > 0
  int max_iterations = 60;        ///< Newton steps; >= 1
};
struct Equilibrium {
  std::vector<Vec3> displacement;  ///< [mm] one per node of the mesh
  std::vector<Vec3> reaction;      ///< [N] push of each support on the body; zero on free nodes
  double residual = 0;             ///< [N] largest force component left on a free node
  int iterations = 0;
};

/// Minimises E(u) = sum V psi(F(u)) - f . u over the free nodes. The held nodes must stop all six
/// rigid motions. Supports and loads are applied at once where that works, in halved steps where it
/// does not.
/// @throws InputError  names the first bad node or tet; nothing was computed
/// @throws SolveError  tolerance not reached; carries residual and iteration count
/// @note Deterministic, re-entrant, allocates.
[[nodiscard]] Equilibrium solve_equilibrium(const TetMesh& mesh, const TissueLaws& laws,
                                            std::span<const HeldNode> held,
                                            std::span<const NodalLoad> loads,
                                            const EquilibriumOptions& options = {});

}  // namespace palpate::fem
