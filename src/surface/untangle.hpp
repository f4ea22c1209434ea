// SPDX-License-Identifier: GPL-3.0-or-later
// Removes self-intersections of a closed surface.
#pragma once
#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"

namespace palpate::surface {

/// Smooths, then cuts out and fills, the faces that meet others; all else stays as it is.
/// All coordinates are rounded to single precision, and the result is free of intersections as
/// such.
/// @pre closed, compact
/// @param edge  [mm] of the mesh
/// @return false where intersections remain; the mesh is then in some closed state
[[nodiscard]] bool untangle(CornerMesh& mesh, double edge, const Progress& progress);

}  // namespace palpate::surface
