// SPDX-License-Identifier: GPL-3.0-or-later
// Exact checks with CGAL's predicates (CGAL Polygon Mesh Processing, "self_intersections").
#include "tetmesh/surface_checks.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "core/error.hpp"

namespace palpate::tetmesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

std::uint64_t directed(std::int32_t a, std::int32_t b) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) |
         static_cast<std::uint32_t>(b);
}

std::string where(const SurfaceMesh& mesh, std::size_t t) {
  const auto& tri = mesh.triangles[t];
  const Vec3 c = (mesh.points[tri[0]] + mesh.points[tri[1]] + mesh.points[tri[2]]) / 3;
  return fmt::format("triangle {} near ({:.1f}, {:.1f}, {:.1f}) mm", t, c.x(), c.y(), c.z());
}

/// Appends a mesh's points and triangles; throws where three or more triangles share an edge.
void append(Mesh& out, const SurfaceMesh& mesh, std::string_view what) {
  std::vector<Mesh::Vertex_index> index;
  index.reserve(mesh.points.size());
  for (const Vec3& p : mesh.points) index.push_back(out.add_vertex({p.x(), p.y(), p.z()}));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (out.add_face(index[a], index[b], index[c]) == Mesh::null_face())
      throw InputError(fmt::format("{} is not a manifold at {}; repair it (palpate build does)",
                                   what, where(mesh, t)));
  }
}

}  // namespace

void require_closed(const SurfaceMesh& mesh, std::string_view what) {
  if (mesh.empty()) throw InputError(fmt::format("{} has no triangles", what));
  if (const auto defect = first_defect(mesh))
    throw InputError(fmt::format("{}: {}", what, *defect));
  std::unordered_map<std::uint64_t, std::size_t> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& tri = mesh.triangles[t];
    for (int i = 0; i < 3; ++i)
      if (tri[i] == tri[(i + 1) % 3] ||
          !edges.emplace(directed(tri[i], tri[(i + 1) % 3]), t).second)
        throw InputError(fmt::format("{} has an edge used twice in one direction at {}; repair it",
                                     what, where(mesh, t)));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& tri = mesh.triangles[t];
    for (int i = 0; i < 3; ++i)
      if (!edges.contains(directed(tri[(i + 1) % 3], tri[i])))
        throw InputError(fmt::format("{} is open at {}; close it before meshing the volume", what,
                                     where(mesh, t)));
  }
  if (!(signed_volume(mesh) > 0))
    throw InputError(fmt::format("{} is inside out: its normals must point outwards", what));
}

void require_apart(const SurfaceMesh& skin, const SurfaceMesh& skull) {
  Mesh both;
  append(both, skin, "skin");
  append(both, skull, "skull");
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(both, std::back_inserter(pairs));
  if (pairs.empty()) return;
  for (auto& [a, b] : pairs)
    if (b < a) std::swap(a, b);
  const auto [a, b] = *std::min_element(pairs.begin(), pairs.end());
  const std::size_t skin_count = skin.triangles.size();
  const std::size_t i = a, j = b;
  const bool a_skin = i < skin_count, b_skin = j < skin_count;
  const auto describe = [&](std::size_t t, bool on_skin) {
    return on_skin ? "skin " + where(skin, t) : "skull " + where(skull, t - skin_count);
  };
  throw InputError(fmt::format(
      "{} meets {} ({} such pairs): {}", describe(i, a_skin), describe(j, b_skin), pairs.size(),
      a_skin != b_skin ? "the skull must lie inside the skin; fit it with a larger clearance"
                       : "the surface runs through itself; repair it there"));
}

}  // namespace palpate::tetmesh
