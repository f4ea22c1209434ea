// SPDX-License-Identifier: GPL-3.0-or-later
// One point well inside each region that the mesher is to fill.
#pragma once
#include <vector>

#include "surface/query.hpp"
#include "tetmesh/tetgen_files.hpp"

namespace palpate::tetmesh {

/// Connected pieces of a mesh, each with its own points; in the order of their first triangle.
[[nodiscard]] std::vector<SurfaceMesh> connected_pieces(const SurfaceMesh& mesh);

/// A point inside a closed piece of bone (on the inner side of `piece`), as far from its surface as
/// the middle of one of a few hundred chords can be.
/// @throws InputError  no chord has its middle inside
[[nodiscard]] Vec3 point_in_bone(const SurfaceMesh& piece);

/// A point inside the skin and outside the skull, chosen likewise among chords that leave the skull
/// outwards. @throws InputError  the skull is not inside the skin
[[nodiscard]] Vec3 point_in_flesh(const surface::SurfaceQuery& skin,
                                  const surface::SurfaceQuery& skull);

}  // namespace palpate::tetmesh
