// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>

#include "core/surface_mesh.hpp"

namespace palpate::tetmesh::scenes {

/// Icosahedron split `levels` times, pushed onto a sphere [mm]; closed, normals out.
inline SurfaceMesh sphere(double radius, int levels, const Vec3& centre = Vec3::Zero()) {
  SurfaceMesh m;
  const double g = 0.5 * (1 + std::sqrt(5.0));
  m.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto split = [&](int a, int b) {
      const auto [it, added] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(m.points.size()));
      if (added) m.points.push_back(0.5 * (m.points[a] + m.points[b]));
      return it->second;
    };
    std::vector<Triangle> next;
    for (const auto& [a, b, c] : m.triangles) {
      const int ab = split(a, b), bc = split(b, c), ca = split(c, a);
      next.insert(next.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    m.triangles = std::move(next);
    for (Vec3& p : m.points) p.normalize();
  }
  for (Vec3& p : m.points) p = centre + radius * p.normalized();
  return m;
}

}  // namespace palpate::tetmesh::scenes
