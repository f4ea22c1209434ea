// SPDX-License-Identifier: GPL-3.0-or-later
// A scan's end shows in two ways: triangles that repair put in, and, on a scan that came closed, a
// flat face. Both are patches of the triangle graph; a patch is grown from each seed over edges
// whose two triangles qualify.
#include "registration/cut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace palpate::registration {
namespace {

using Neighbours = std::vector<std::array<std::int32_t, 3>>;

/// Per triangle the triangle across each of its edges, -1 where there is none.
Neighbours edge_neighbours(const SurfaceMesh& mesh) {
  Neighbours across(mesh.triangles.size(), {-1, -1, -1});
  std::unordered_map<std::uint64_t, std::pair<std::int32_t, int>> open;
  open.reserve(2 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(mesh.triangles[t][k]);
      const auto b = static_cast<std::uint32_t>(mesh.triangles[t][(k + 1) % 3]);
      const std::uint64_t key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
      const auto [at, is_new] = open.try_emplace(key, static_cast<std::int32_t>(t), k);
      if (is_new) continue;
      across[t][k] = at->second.first;
      across[at->second.first][at->second.second] = static_cast<std::int32_t>(t);
    }
  return across;
}

double triangle_area(const SurfaceMesh& mesh, std::size_t t) {
  const Triangle& c = mesh.triangles[t];
  return 0.5 * (mesh.points[c[1]] - mesh.points[c[0]])
                   .cross(mesh.points[c[2]] - mesh.points[c[0]])
                   .norm();
}

/// Connected patches of triangles; `joins(seed, b)` says whether b may belong to the seed's patch.
template <typename Member, typename Joins>
std::vector<std::vector<std::int32_t>> patches(const Neighbours& across, Member is_member,
                                               Joins joins) {
  std::vector<std::vector<std::int32_t>> found;
  std::vector<std::uint8_t> seen(across.size(), 0);
  for (std::size_t seed = 0; seed < across.size(); ++seed) {
    if (seen[seed] || !is_member(seed)) continue;
    std::vector<std::int32_t> patch{static_cast<std::int32_t>(seed)};
    seen[seed] = 1;
    for (std::size_t i = 0; i < patch.size(); ++i)
      for (const std::int32_t next : across[patch[i]])
        if (next >= 0 && !seen[next] && is_member(next) && joins(patch[0], next)) {
          seen[next] = 1;
          patch.push_back(next);
        }
    found.push_back(std::move(patch));
  }
  return found;
}

CutPlane plane_of(const SurfaceMesh& mesh, const std::vector<Vec3>& normals,
                  const std::vector<std::int32_t>& patch) {
  CutPlane plane;
  for (const std::int32_t t : patch) {
    const double area = triangle_area(mesh, t);
    plane.area_mm2 += area;
    plane.normal += area * normals[t];
  }
  plane.normal.stableNormalize();
  plane.offset = std::numeric_limits<double>::infinity();
  for (const std::int32_t t : patch)
    for (const std::int32_t v : mesh.triangles[t])
      plane.offset = std::min(plane.offset, plane.normal.dot(mesh.points[v]));
  return plane;
}

}  // namespace

ScanEnds find_scan_ends(const HeadSurface& head, const CutOptions& options) {
  const SurfaceMesh& mesh = head.skin;
  const std::vector<Vec3> normals = triangle_normals(mesh);
  const Neighbours across = edge_neighbours(mesh);
  ScanEnds ends;
  ends.cap.assign(mesh.points.size(), 0);
  ends.no_scan.assign(mesh.points.size(), 0);
  for (std::size_t i = 0; i < head.filled.size(); ++i) ends.no_scan[i] = head.filled[i] == 1;

  const auto filled = [&](std::size_t t) {
    const Triangle& c = mesh.triangles[t];
    return ends.no_scan[c[0]] && ends.no_scan[c[1]] && ends.no_scan[c[2]];
  };
  const double flat = std::cos(options.flat_angle * std::numbers::pi / 180);
  const auto coplanar = [&](std::size_t seed, std::size_t t) {
    const Vec3 between = mesh.points[mesh.triangles[t][0]] - mesh.points[mesh.triangles[seed][0]];
    return normals[seed].dot(normals[t]) > flat &&
           std::abs(normals[seed].dot(between)) < options.flat_height;
  };
  const auto keep = [&](const std::vector<std::vector<std::int32_t>>& found) {
    for (const std::vector<std::int32_t>& patch : found) {
      const CutPlane plane = plane_of(mesh, normals, patch);
      if (plane.area_mm2 < options.least_area) continue;
      ends.planes.push_back(plane);
      for (const std::int32_t t : patch)
        for (const std::int32_t v : mesh.triangles[t]) ends.cap[v] = ends.no_scan[v] = 1;
    }
  };
  keep(patches(across, filled, [](auto, auto) { return true; }));
  const std::vector<std::uint8_t> from_repair = ends.no_scan;
  const auto scanned = [&](std::size_t t) {
    const Triangle& c = mesh.triangles[t];
    return !(from_repair[c[0]] && from_repair[c[1]] && from_repair[c[2]]);
  };
  keep(patches(across, scanned, coplanar));
  for (std::size_t i = 0; i < head.filled.size(); ++i) ends.no_scan[i] |= head.filled[i] != 0;
  std::stable_sort(ends.planes.begin(), ends.planes.end(),
                   [](const CutPlane& a, const CutPlane& b) { return a.area_mm2 > b.area_mm2; });
  return ends;
}

}  // namespace palpate::registration
