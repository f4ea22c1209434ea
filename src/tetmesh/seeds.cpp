// SPDX-License-Identifier: GPL-3.0-or-later
// A seed must not lie on or near a facet: TetGen finds the tetrahedron that holds it and floods the
// region from there. So: from triangle centres spread over the surface, the chord to the opposite
// side; its middle, checked by the side of both surfaces; the one with the most room wins.
#include "tetmesh/seeds.hpp"

#include <algorithm>
#include <numeric>

#include "core/error.hpp"

namespace palpate::tetmesh {
namespace {

constexpr std::size_t kChords = 400;  ///< tries; more finds more room, ten would do for a sphere
constexpr double kStart = 1e-6;       ///< [mm] a ray must not meet the triangle that it leaves

/// Calls visit(centre, outward normal) for triangles spread evenly over the list.
template <class Visit>
void spread(const SurfaceMesh& mesh, Visit visit) {
  const auto normals = triangle_normals(mesh);
  const std::size_t step = std::max<std::size_t>(1, mesh.triangles.size() / kChords);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (normals[t].isZero()) continue;
    visit(Vec3((mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3), normals[t]);
  }
}

struct Best {
  Vec3 point = Vec3::Zero();
  double room = 0;
  void offer(const Vec3& p, double r) {
    if (r > room) point = p, room = r;
  }
};

std::int32_t root(std::vector<std::int32_t>& parent, std::int32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

std::vector<SurfaceMesh> connected_pieces(const SurfaceMesh& mesh) {
  std::vector<std::int32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& [a, b, c] : mesh.triangles) {
    parent[root(parent, b)] = root(parent, a);
    parent[root(parent, c)] = root(parent, a);
  }
  std::vector<SurfaceMesh> pieces;
  std::vector<std::int32_t> piece_of(mesh.points.size(), -1), local(mesh.points.size(), -1);
  for (const auto& tri : mesh.triangles) {
    std::int32_t& piece = piece_of[root(parent, tri[0])];
    if (piece < 0) {
      piece = static_cast<std::int32_t>(pieces.size());
      pieces.emplace_back();
    }
    SurfaceMesh& out = pieces[piece];
    Triangle moved;
    for (int i = 0; i < 3; ++i) {
      if (local[tri[i]] < 0) {
        local[tri[i]] = static_cast<std::int32_t>(out.points.size());
        out.points.push_back(mesh.points[tri[i]]);
      }
      moved[i] = local[tri[i]];
    }
    out.triangles.push_back(moved);
  }
  return pieces;
}

Vec3 point_in_bone(const SurfaceMesh& piece) {
  const surface::SurfaceQuery query(piece);
  Best best;
  spread(piece, [&](const Vec3& centre, const Vec3& normal) {
    const auto hit = query.cast(centre, -normal, 1e9, kStart);
    if (!hit) return;
    const Vec3 middle = centre - 0.5 * hit->distance * normal;
    best.offer(middle, -query.signed_distance(middle));
  });
  if (best.room <= 0) throw InputError("skull: no point inside was found; is it closed?");
  return best.point;
}

Vec3 point_in_flesh(const surface::SurfaceQuery& skin, const surface::SurfaceQuery& skull) {
  Best best;
  spread(skull.mesh(), [&](const Vec3& centre, const Vec3& normal) {
    const auto out = skin.cast(centre, normal, 1e9, kStart);
    if (!out) return;
    double reach = out->distance;
    if (const auto bone = skull.cast(centre, normal, reach, kStart)) reach = bone->distance;
    const Vec3 middle = centre + 0.5 * reach * normal;
    best.offer(middle, std::min(-skin.signed_distance(middle), skull.signed_distance(middle)));
  });
  if (best.room <= 0) throw InputError("the skull does not lie inside the skin; fit it again");
  return best.point;
}

}  // namespace palpate::tetmesh
