// SPDX-License-Identifier: GPL-3.0-or-later
// Heads that can be written down.
#pragma once
#include <cmath>
#include <map>

#include "core/head_surface.hpp"
#include "core/skull.hpp"

namespace palpate::stiffness::scenes {

/// Unit sphere, icosahedron split `times` times (10 * 4^times + 2 points).
inline SurfaceMesh sphere(int times) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  SurfaceMesh m;
  m.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  m.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<int, int>, int> middle;
    std::vector<Triangle> finer;
    const auto mid = [&](int a, int b) {
      const auto [at, fresh] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(m.points.size()));
      if (fresh) m.points.push_back(0.5 * (m.points[a] + m.points[b]));
      return at->second;
    };
    for (const auto& [a, b, c] : m.triangles) {
      const int ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    m.triangles = finer;
  }
  for (Vec3& p : m.points) p.normalize();
  return m;
}

inline SurfaceMesh ellipsoid(int times, const Vec3& radii, const Vec3& center = Vec3::Zero()) {
  SurfaceMesh m = sphere(times);
  for (Vec3& p : m.points) p = p.cwiseProduct(radii) + center;
  return m;
}

/// Ellipsoidal head: 3 mm of tissue at the crown, more towards the face (+z) and the jaw (-y).
struct Head {
  HeadSurface skin;
  SkullFit skull;
};
inline Head head(int times = 4) {
  Head h;
  h.skin.skin = ellipsoid(times, {75, 100, 90});
  h.skin.filled.assign(h.skin.skin.points.size(), 0);
  h.skin.region.assign(h.skin.skin.points.size(), SkinRegion::cheek);
  h.skull.mesh = ellipsoid(times, {68, 91, 82}, {0, 5, -3});
  h.skull.region.assign(h.skull.mesh.points.size(), SkullRegion::none);
  return h;
}

inline Head mapped(Head h, const Mat3& linear) {
  for (auto* mesh : {&h.skin.skin, &h.skull.mesh}) {
    for (Vec3& p : mesh->points) p = linear * p;
    if (linear.determinant() < 0)
      for (Triangle& t : mesh->triangles) std::swap(t[1], t[2]);
  }
  return h;
}

}  // namespace palpate::stiffness::scenes
