// SPDX-License-Identifier: GPL-3.0-or-later
// Where a surface passes through itself.
#pragma once
#include <utility>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::surface {

/// Pairs of triangles that meet elsewhere than in a corner or edge that they share, ascending; and
/// (t, t) for a triangle without area. Exact predicates.
/// @pre closed 2-manifold
[[nodiscard]] std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(
    const SurfaceMesh& mesh);

}  // namespace palpate::surface
