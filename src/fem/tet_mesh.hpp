// SPDX-License-Identifier: GPL-3.0-or-later
// A tetrahedral mesh of either order, ready for elements.
#pragma once
#include <cstdint>
#include <vector>

#include "fem/element.hpp"

namespace palpate::fem {

/// Nodes [mm] and tetrahedra; tet t holds nodes tets[t * tet_nodes(order) ...] in the order that
/// element.hpp states.
struct TetMesh {
  ElementOrder order = ElementOrder::linear;
  std::vector<Vec3> nodes;
  std::vector<std::int32_t> tets;

  [[nodiscard]] int size() const { return static_cast<int>(tets.size()) / tet_nodes(order); }
  [[nodiscard]] const std::int32_t* tet(int t) const { return &tets[t * tet_nodes(order)]; }
};

/// Faces of elements, stride face_nodes(order), outward orientation.
using FaceList = std::vector<std::int32_t>;

/// Adds a node in the middle of each edge; corners keep their numbers, new nodes follow in the
/// order in which the tets first name their edges.
/// @param mesh   linear
/// @param edges  filled, when given, with the two corners of each new node
[[nodiscard]] TetMesh to_quadratic(const TetMesh& mesh,
                                   std::vector<std::array<std::int32_t, 2>>* edges = nullptr);

/// Faces that belong to one tetrahedron only, in the order of the tets.
[[nodiscard]] FaceList boundary_faces(const TetMesh& mesh);

/// Signed volume of the corner tetrahedron [mm^3].
[[nodiscard]] double corner_volume(const TetMesh& mesh, int tet);

/// @throws InputError  names the first tet that is inverted or degenerate (volume below 1e-12 of
/// its longest edge cubed) or that names a node out of range
void check_mesh(const TetMesh& mesh);

}  // namespace palpate::fem
