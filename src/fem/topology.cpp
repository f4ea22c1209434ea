// SPDX-License-Identifier: GPL-3.0-or-later
// The three columns of free node b hold, below the diagonal, the same node rows: for component k
// first the 3 - k diagonal entries, then three rows per neighbour a > b, then the travel's row.
#include "fem/topology.hpp"

#include <algorithm>
#include <cassert>

namespace palpate::fem {
namespace {

/// For each free node the free nodes above it that share a tetrahedron, ascending.
std::vector<std::vector<std::int32_t>> upper_neighbours(const Topology& t) {
  std::vector<std::vector<std::int32_t>> above(t.free_nodes);
  const int stride = tet_nodes(t.order);
  for (std::size_t first = 0; first < t.tets.size(); first += stride)
    for (int i = 0; i < stride; ++i)
      for (int j = 0; j < stride; ++j) {
        const int a = t.free_node[t.tets[first + i]], b = t.free_node[t.tets[first + j]];
        if (a > b && b >= 0) above[b].push_back(a);
      }
  for (auto& list : above) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return above;
}

SparsePattern make_pattern(const Topology& t) {
  std::vector<std::uint8_t> touched(t.free_nodes, 0);
  for (const std::int32_t node : t.contact_faces)
    if (t.free_node[node] >= 0) touched[t.free_node[node]] = 1;
  SparsePattern p{t.unknowns(), {0}, {}};
  const auto above = upper_neighbours(t);
  for (int b = 0; b < t.free_nodes; ++b)
    for (int k = 0; k < 3; ++k) {
      for (int i = k; i < 3; ++i) p.row.push_back(3 * b + i);
      for (const int a : above[b])
        for (int i = 0; i < 3; ++i) p.row.push_back(3 * a + i);
      if (t.has_travel && touched[b]) p.row.push_back(t.travel());
      p.column_start.push_back(static_cast<int>(p.row.size()));
    }
  if (t.has_travel) {
    p.row.push_back(t.travel());
    p.column_start.push_back(static_cast<int>(p.row.size()));
  }
  return p;
}

}  // namespace

void Topology::add_block(std::vector<double>& values, int a, int b, const Mat3& block) const {
  if (a < b) return add_block(values, b, a, block.transpose());
  const auto& start = pattern.column_start;
  if (a == b) {
    for (int k = 0; k < 3; ++k)
      for (int i = k; i < 3; ++i) values[start[3 * b + k] + i - k] += block(i, k);
    return;
  }
  const auto from = pattern.row.begin() + start[3 * b], to = pattern.row.begin() + start[3 * b + 1];
  const int rank = static_cast<int>(std::lower_bound(from, to, 3 * a) - from) - 3;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 3; ++i) values[start[3 * b + k] + 3 - k + rank + i] += block(i, k);
}

void Topology::add_travel_row(std::vector<double>& values, int b, const Vec3& row) const {
  for (int k = 0; k < 3; ++k) {
    const int last = pattern.column_start[3 * b + k + 1] - 1;
    assert(pattern.row[last] == travel());
    values[last] += row[k];
  }
}

Topology make_topology(const TetMesh& mesh, std::span<const std::uint8_t> held, FaceList faces) {
  Topology t;
  t.order = mesh.order;
  t.tets = mesh.tets;
  t.has_travel = !faces.empty();
  t.contact_faces = std::move(faces);
  t.free_node.assign(mesh.nodes.size(), -1);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (!held[n]) t.free_node[n] = t.free_nodes++;
  t.pattern = make_pattern(t);
  return t;
}

}  // namespace palpate::fem
