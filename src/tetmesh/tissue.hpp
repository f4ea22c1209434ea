// SPDX-License-Identifier: GPL-3.0-or-later
// Flesh and bone tetrahedra between skin and skull.
#pragma once
#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "core/tissue_mesh.hpp"

namespace palpate::tetmesh {

struct TissueOptions {
  double radius_edge_ratio = 1.4;  ///< [-] TetGen -q; >= 1.2
  double max_volume = 10;          ///< [mm^3] TetGen -a; > 0
  double no_bone_beyond = 40;  ///< [mm] skin farther from bone than this along the normal is held
};

/// @throws InputError  skin and skull intersect or are open: names the first triangle
/// @throws SolveError  the mesher failed; carries its last line
[[nodiscard]] TissueMesh make_tissue_mesh(const HeadSurface& head, const SkullFit& skull,
                                          const TissueOptions& options = {},
                                          const Progress& progress = {});

}  // namespace palpate::tetmesh
