// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form shapes for the tests of this folder.
#pragma once
#include <cmath>
#include <map>
#include <numbers>

#include "core/surface_mesh.hpp"

namespace palpate::surface::shapes {

/// Subdivided octahedron projected on a sphere: 8 * 4^level triangles, normals out.
inline SurfaceMesh sphere(double radius, int level, const Vec3& center = Vec3::Zero()) {
  SurfaceMesh m;
  m.points = {Vec3::UnitX(),  -Vec3::UnitX(), Vec3::UnitY(),
              -Vec3::UnitY(), Vec3::UnitZ(),  -Vec3::UnitZ()};
  m.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<int, int>, int> middle;
    const auto mid = [&](int a, int b) {
      const auto [it, fresh] =
          middle.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(m.points.size()));
      if (fresh) m.points.push_back((m.points[a] + m.points[b]).normalized());
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : m.triangles) {
      const int ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    m.triangles = std::move(finer);
  }
  for (Vec3& p : m.points) p = center + radius * p;
  return m;
}

/// z = f(x, y) on a square grid of side 2 * half with (n+1)^2 points, normals towards +z.
template <class Height>
SurfaceMesh graph(double half, int n, Height f) {
  SurfaceMesh m;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1), y = half * (2.0 * j / n - 1);
      m.points.emplace_back(x, y, f(x, y));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      m.triangles.push_back({a, a + 1, a + n + 2});
      m.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return m;
}

/// Closed grid on (u, v) in [0, 2 pi)^2 or open in u where `wrap_u` is false.
template <class Point>
SurfaceMesh grid(int nu, int nv, bool wrap_u, Point at) {
  SurfaceMesh m;
  const int rows = wrap_u ? nu : nu + 1;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < nv; ++j)
      m.points.push_back(at(static_cast<double>(i) / nu, 2 * std::numbers::pi * j / nv));
  for (int i = 0; i < nu; ++i)
    for (int j = 0; j < nv; ++j) {
      const int i1 = (i + 1) % rows, j1 = (j + 1) % nv;
      const int a = i * nv + j, b = i1 * nv + j, c = i1 * nv + j1, d = i * nv + j1;
      m.triangles.push_back({a, b, c});
      m.triangles.push_back({a, c, d});
    }
  return m;
}

inline SurfaceMesh cube(double half) {
  SurfaceMesh m;
  for (int i = 0; i < 8; ++i)
    m.points.emplace_back(i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half);
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

inline void append(SurfaceMesh& m, const SurfaceMesh& other) {
  const auto shift = static_cast<std::int32_t>(m.points.size());
  m.points.insert(m.points.end(), other.points.begin(), other.points.end());
  for (const Triangle& t : other.triangles)
    m.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
}

/// Deterministic points in [-1, 1]^3 (a Halton sequence).
inline Vec3 halton(int i) {
  const auto radical = [](int n, int base) {
    double f = 1, r = 0;
    for (; n > 0; n /= base) r += (f /= base) * (n % base);
    return r;
  };
  return {2 * radical(i + 1, 2) - 1, 2 * radical(i + 1, 3) - 1, 2 * radical(i + 1, 5) - 1};
}

}  // namespace palpate::surface::shapes
