// SPDX-License-Identifier: GPL-3.0-or-later
// One closed skin of two pieces that lie edge to edge.
#pragma once
#include <cstdint>
#include <vector>

#include "core/progress.hpp"
#include "core/surface_mesh.hpp"

namespace palpate::surface {

struct JoinedSurface {
  SurfaceMesh mesh;                   ///< closed 2-manifold, normals out, no self-intersection
  std::vector<std::int32_t> nearest;  ///< one per point: the nearest triangle of the first piece,
                                      ///< or, counted on from its last, of the second
};

/// Points lie on the pieces, gaps apart, and faces follow them.
/// @param first, second  [mm] open surfaces, outward-oriented
/// @param around         [mm] closed 2-manifold, normals out, a few mm off both; bridges the gaps
/// @param edge           [mm] of the result
/// @throws InputError    the result passes through itself
/// @note Deterministic; same bits for any thread count.
[[nodiscard]] JoinedSurface join_surfaces(const SurfaceMesh& first, const SurfaceMesh& second,
                                          const SurfaceMesh& around, double edge,
                                          const Progress& progress = {});

}  // namespace palpate::surface
