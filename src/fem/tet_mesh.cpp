// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/tet_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

using Edge = std::array<std::int32_t, 2>;

// Face opposite to each corner, seen from outside; with the mid-edge nodes of P2.
constexpr std::array<std::array<int, 6>, 4> kTetFaces = {
    {{1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}}};

}  // namespace

TetMesh to_quadratic(const TetMesh& mesh, std::vector<Edge>* edges) {
  TetMesh out{ElementOrder::quadratic, mesh.nodes, {}};
  out.tets.reserve(mesh.size() * 10);
  std::map<Edge, std::int32_t> middle;
  for (int t = 0; t < mesh.size(); ++t) {
    const std::int32_t* corner = mesh.tet(t);
    out.tets.insert(out.tets.end(), corner, corner + 4);
    for (const auto& [i, j] : kTetEdges) {
      const Edge key = {std::min(corner[i], corner[j]), std::max(corner[i], corner[j])};
      const auto [at, is_new] = middle.try_emplace(key, static_cast<int>(out.nodes.size()));
      if (is_new) {
        out.nodes.push_back(0.5 * (mesh.nodes[key[0]] + mesh.nodes[key[1]]));
        if (edges) edges->push_back(key);
      }
      out.tets.push_back(at->second);
    }
  }
  return out;
}

FaceList boundary_faces(const TetMesh& mesh) {
  std::map<std::array<std::int32_t, 3>, int> seen;
  const auto key = [&mesh](int t, int f) {
    std::array<std::int32_t, 3> k;
    for (int i = 0; i < 3; ++i) k[i] = mesh.tet(t)[kTetFaces[f][i]];
    std::sort(k.begin(), k.end());
    return k;
  };
  for (int t = 0; t < mesh.size(); ++t)
    for (int f = 0; f < 4; ++f) ++seen[key(t, f)];
  FaceList faces;
  for (int t = 0; t < mesh.size(); ++t)
    for (int f = 0; f < 4; ++f) {
      if (seen[key(t, f)] != 1) continue;
      for (int i = 0; i < face_nodes(mesh.order); ++i)
        faces.push_back(mesh.tet(t)[kTetFaces[f][i]]);
    }
  return faces;
}

double corner_volume(const TetMesh& mesh, int t) {
  const std::int32_t* n = mesh.tet(t);
  const Vec3& a = mesh.nodes[n[0]];
  return (mesh.nodes[n[1]] - a).cross(mesh.nodes[n[2]] - a).dot(mesh.nodes[n[3]] - a) / 6;
}

void check_mesh(const TetMesh& mesh) {
  constexpr double kDegenerate = 1e-12;  // [-] of the longest edge cubed
  const int stride = tet_nodes(mesh.order);
  for (int t = 0; t < mesh.size(); ++t) {
    for (int i = 0; i < stride; ++i)
      if (mesh.tet(t)[i] < 0 || mesh.tet(t)[i] >= static_cast<int>(mesh.nodes.size()))
        throw InputError(fmt::format("tetrahedron {} names node {}, the mesh has {} nodes", t,
                                     mesh.tet(t)[i], mesh.nodes.size()));
    double longest = 0;
    for (const auto& [i, j] : kTetEdges)
      longest = std::max(longest, (mesh.nodes[mesh.tet(t)[i]] - mesh.nodes[mesh.tet(t)[j]]).norm());
    const double volume = corner_volume(mesh, t);
    if (!(volume > kDegenerate * longest * longest * longest))
      throw InputError(fmt::format(
          "tetrahedron {} is inverted or degenerate (volume {} mm^3); repair the mesh", t, volume));
  }
}

}  // namespace palpate::fem
