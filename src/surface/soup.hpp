// SPDX-License-Identifier: GPL-3.0-or-later
// From a triangle soup to one oriented 2-manifold piece with borders.
#pragma once
#include "surface/corner_mesh.hpp"
#include "surface/repair.hpp"

namespace palpate::surface {

/// Welds points, drops degenerate and duplicate faces, cuts non-manifold spots, orients, keeps the
/// largest piece and turns its normals out. Writes what it found into `report`.
/// @param scan  finite coordinates, valid indices
/// @throws InputError  nothing with an area is left
[[nodiscard]] CornerMesh manifold_from_soup(const SurfaceMesh& scan, RepairReport& report);

/// Signed volume [mm^3] with each border loop closed by a fan to its centroid.
[[nodiscard]] double capped_volume(const CornerMesh& mesh);

}  // namespace palpate::surface
