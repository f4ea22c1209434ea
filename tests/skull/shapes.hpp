// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes with known answers: ellipsoids and their parallel surfaces.
#pragma once
#include <cmath>
#include <map>
#include <utility>

#include "core/head_surface.hpp"
#include "core/skull.hpp"

namespace palpate::skull {

/// Unit sphere of 20 * 4^levels triangles, mirror symmetric about x = 0, normals out.
inline SurfaceMesh unit_sphere(int levels) {
  SurfaceMesh mesh{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto [at, is_new] = middle.try_emplace(std::minmax(a, b), int(mesh.points.size()));
      if (is_new) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const int ab = between(t[0], t[1]), bc = between(t[1], t[2]), ca = between(t[2], t[0]);
      finer.push_back({t[0], ab, ca});
      finer.push_back({ab, t[1], bc});
      finer.push_back({ca, bc, t[2]});
      finer.push_back({ab, bc, ca});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// Ellipsoid x^T diag(1/axes^2) x = 1, pushed out by `offset` [mm] along its normals.
inline SurfaceMesh ellipsoid(const Vec3& axes, double offset, int levels) {
  SurfaceMesh mesh = unit_sphere(levels);
  for (Vec3& p : mesh.points)
    p = axes.cwiseProduct(p) + offset * p.cwiseQuotient(axes).normalized();
  return mesh;
}

inline HeadSurface head_of(SurfaceMesh skin) {
  HeadSurface head;
  head.filled.assign(skin.points.size(), 0);
  head.region.assign(skin.points.size(), SkinRegion::other);
  head.skin = std::move(skin);
  return head;
}

/// An egg-shaped "skull" whose landmarks all have the same published depth.
inline SkullTemplate egg_template(const Vec3& axes) {
  SkullTemplate skull;
  skull.name = "egg";
  skull.mesh = ellipsoid(axes, 0, 5);
  skull.region.assign(skull.mesh.points.size(), SkullRegion::cranium);
  const auto on = [&](const Vec3& direction) {
    const Vec3 p = axes.cwiseProduct(direction.normalized());
    return SkullLandmark{p, p.cwiseQuotient(axes).cwiseQuotient(axes).normalized()};
  };
  skull.landmarks = {{"v", on({0, 1, 0})},         {"op", on({0, 0, -1})},
                     {"g", on({0, 0.3, 1})},       {"n", on({0, 0, 1})},
                     {"zy_left", on({1, 0, 0.5})}, {"zy_right", on({-1, 0, 0.5})}};
  skull.registration_points = {{"nose_tip", {0, -20, axes.z() + 10}},
                               {"eye_outer_left", {40, 0, axes.z() - 10}},
                               {"eye_outer_right", {-40, 0, axes.z() - 10}},
                               {"nose_corner_left", {16, -22, axes.z()}},
                               {"nose_corner_right", {-16, -22, axes.z()}}};
  return skull;
}

inline std::vector<TissueDepth> even_table(double mean) {
  std::vector<TissueDepth> table;
  for (const char* code : {"v", "op", "g", "n", "zy"})
    table.push_back({code, code, mean, 2, "test"});
  return table;
}

}  // namespace palpate::skull
