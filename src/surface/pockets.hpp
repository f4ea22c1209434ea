// SPDX-License-Identifier: GPL-3.0-or-later
// Pockets that open to the outside through a narrow mouth: eye sockets, the mouth, nostrils.
#pragma once
#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"

namespace palpate::surface {

struct Pockets {
  std::size_t count = 0;
  std::vector<std::uint8_t> face;  ///< one per face: 1 inside a pocket
};

/// Faces that see little of the outside, in regions much larger than their openings.
/// @pre closed, outward-oriented, evenly triangulated, not empty
/// @param edge  [mm] of the mesh
/// @note Deterministic; same bits for any thread count.
[[nodiscard]] Pockets find_pockets(const CornerMesh& mesh, double edge, const Progress& progress);

}  // namespace palpate::surface
