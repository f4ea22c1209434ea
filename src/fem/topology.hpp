// SPDX-License-Identifier: GPL-3.0-or-later
// What meshes of equal connectivity share: the numbering of unknowns and the pattern of the
// Hessian.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fem/tet_mesh.hpp"

namespace palpate::fem {

/// Lower triangle of a symmetric matrix by columns, rows ascending.
struct SparsePattern {
  int size = 0;
  std::vector<std::int32_t> column_start;  ///< size + 1
  std::vector<std::int32_t> row;
};

/// Unknowns: three displacements per free node, then `travel` when `has_travel`: one scalar that
/// couples with the nodes of the contact faces.
struct Topology {
  ElementOrder order = ElementOrder::linear;
  std::vector<std::int32_t> tets;       ///< as in TetMesh
  FaceList contact_faces;               ///< skin that may be touched
  std::vector<std::int32_t> free_node;  ///< per node: its number among the free ones, -1 where held
  int free_nodes = 0;
  bool has_travel = false;
  SparsePattern pattern;

  [[nodiscard]] int unknowns() const { return 3 * free_nodes + (has_travel ? 1 : 0); }
  [[nodiscard]] int travel() const { return 3 * free_nodes; }

  /// Adds a 3 x 3 block at free nodes (a, b) and, by symmetry, (b, a).
  void add_block(std::vector<double>& values, int a, int b, const Mat3& block) const;
  /// Adds to the row of the travel at free node b.
  void add_travel_row(std::vector<double>& values, int b, const Vec3& row) const;
};

/// @param mesh           only connectivity and order are used
/// @param held           one per node: non-zero where the node does not move
/// @param contact_faces  may be empty; then there is no travel
[[nodiscard]] Topology make_topology(const TetMesh& mesh, std::span<const std::uint8_t> held,
                                     FaceList contact_faces = {});

}  // namespace palpate::fem
