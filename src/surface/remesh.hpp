// SPDX-License-Identifier: GPL-3.0-or-later
// Thinning and isotropic remeshing of closed surfaces.
#pragma once
#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"
#include "surface/query.hpp"

namespace palpate::surface {

/// Splits edges in their middle until none is longer than `longer` [mm], the longest first.
/// @param first       half-edges from here on
/// @param patch_only  edges of patch faces, their rims included (a long rim edge would allow no
/// end)
void split_long_edges(CornerMesh& mesh, double longer, CornerMesh::Id first = 0,
                      bool patch_only = false);

/// Collapses short edges in passes of growing length until few are shorter than `edge` [mm]. Rims
/// as below.
/// @pre closed
void thin(CornerMesh& mesh, double edge, const Progress& progress);

/// Edges between 4/5 and 4/3 of `edge` [mm], valence near 6; points lie on `target`.
/// Rims between scan and cap stay: their points move along them only.
/// @pre closed
/// @cite Botsch & Kobbelt 2004, "A remeshing approach to multiresolution modeling"
void remesh(CornerMesh& mesh, const SurfaceQuery& target, double edge, int iterations,
            const Progress& progress);

/// Whether no face around v turns by more than 60 degrees when v moves to p.
[[nodiscard]] bool keeps_direction(const CornerMesh& mesh, CornerMesh::Id v, const Vec3& p);

}  // namespace palpate::surface
