// SPDX-License-Identifier: GPL-3.0-or-later
// Flesh and bone tetrahedra between skin and skull.
#pragma once
#include <string>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "core/tissue_mesh.hpp"

namespace palpate::tetmesh {

struct TissueOptions {
  double radius_edge_ratio = 1.4;  ///< [-] TetGen -q; >= 1.2
  double min_dihedral = 10;        ///< [deg] TetGen -q/; 0 to 18, more does not terminate reliably
  double max_volume = 10;          ///< [mm^3] of a flesh tetrahedron; > 0
  double max_bone_volume = 100;  ///< [mm^3] of a bone tetrahedron: bone is held, a coarse one does
  double no_bone_beyond = 40;    ///< [mm] skin farther from bone than this along the normal is held
  double time_limit = 600;       ///< [s] the mesher is stopped after that; a head takes 5 to 20 s
  std::string mesher = "tetgen";  ///< program: a name on PATH or a path (docs/decisions/0002)
};

/// Meshes the volume inside the skin: bone inside the skull, flesh between the two.
///
/// Nodes: the skin's points unmoved and in order, then the skull's points likewise, then the
/// mesher's own. `held` is 1 on every node of a bone tetrahedron (the skull's surface included), on
/// skin points of the regions eye, nose and lips, and on skin points that meet no bone within
/// `no_bone_beyond` along the inward normal. `quality` holds counts, dihedral angles [deg] with
/// their histogram in steps of 10 degrees, and volumes [mm^3] beside those of the surfaces.
///
/// @param head   closed, outward skin, [mm]; `region` empty or one per point
/// @param skull  closed, outward, wholly inside the skin
/// @throws InputError  skin or skull open, inside out, self-intersecting or meeting each other:
///                     names the first triangle; the mesher is not installed
/// @throws SolveError  the mesher failed or took too long; carries its last line
/// @throws Cancelled   the mesher is stopped and its files are removed
/// @note Deterministic. Re-entrant: each call has its own temporary folder.
/// @cite Si 2015, "TetGen, a Delaunay-based quality tetrahedral mesh generator"
[[nodiscard]] TissueMesh make_tissue_mesh(const HeadSurface& head, const SkullFit& skull,
                                          const TissueOptions& options = {},
                                          const Progress& progress = {});

/// Fills `mesh.quality`: nodes, tets_flesh, tets_bone, held_nodes, dihedral_min_deg,
/// dihedral_max_deg, dihedral_mean_min_deg (mean over tets of their smallest angle),
/// dihedral_share_000_010 ... dihedral_share_170_180 [-], tet_volume_min_mm3, volume_flesh_mm3,
/// volume_bone_mm3.
void measure_quality(TissueMesh& mesh);

}  // namespace palpate::tetmesh
