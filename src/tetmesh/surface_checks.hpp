// SPDX-License-Identifier: GPL-3.0-or-later
// What must hold before two surfaces can bound a volume mesh.
#pragma once
#include <string_view>

#include "core/surface_mesh.hpp"

namespace palpate::tetmesh {

/// @param what  "skin" or "skull", for the message
/// @throws InputError  names the first triangle: bad index or coordinate, zero area, an edge that
///                     is not shared by exactly two triangles in opposite directions, or a surface
///                     whose normals point in
void require_closed(const SurfaceMesh& mesh, std::string_view what);

/// @throws InputError  names the first triangle that meets another one, of the same or of the other
///                     surface, other than at a shared edge or corner
/// @note Exact predicates; O((n + k) log n).
void require_apart(const SurfaceMesh& skin, const SurfaceMesh& skull);

}  // namespace palpate::tetmesh
