// SPDX-License-Identifier: Apache-2.0
// Heads in closed form for the tests and the benchmark of touch.
#pragma once
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "core/touchable_head.hpp"

namespace palpate::haptics::scenes {

/// Octahedron cut `n` times along each edge, blown up: 8 n^2 triangles with directions as points.
inline SurfaceMesh unit_sphere(int n) {
  SurfaceMesh m;
  std::map<std::array<int, 3>, std::int32_t> number;
  const auto vertex = [&](int x, int y, int z) {
    const auto [it, fresh] =
        number.try_emplace({x, y, z}, static_cast<std::int32_t>(m.points.size()));
    if (fresh) {
      // The sine spreads the points evenly along the great circles through the corners.
      const auto even = [&](int i) { return std::sin(0.5 * std::numbers::pi * i / n); };
      m.points.push_back(Vec3(even(x), even(y), even(z)).normalized());
    }
    return it->second;
  };
  for (int s = 0; s < 8; ++s) {
    const int sx = s & 1 ? -1 : 1, sy = s & 2 ? -1 : 1, sz = s & 4 ? -1 : 1;
    const auto at = [&](int i, int j) { return vertex(sx * i, sy * j, sz * (n - i - j)); };
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      if (sx * sy * sz > 0)
        m.triangles.push_back({a, b, c});
      else
        m.triangles.push_back({a, c, b});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 2 <= n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return m;
}

/// Each vertex gets the ten-force curve u(f) = softness * 2.5 * (1 - exp(-f / 2)), which stiffens
/// with force as tissue over bone does; softness [mm] as a function of the point.
template <class Softness>
StiffnessMap stiffening_map(const SurfaceMesh& skin, double tool_radius, Softness softness) {
  StiffnessMap map;
  map.tool_radius = tool_radius;
  for (int i = 1; i <= 10; ++i) map.forces.push_back(0.5 * i);
  for (const Vec3& p : skin.points) {
    const double s = softness(p);
    for (const double f : map.forces) map.displacement.push_back(s * 2.5 * (1 - std::exp(-f / 2)));
    map.status.push_back(VertexStatus::solved);
    map.error.push_back(0);
    map.depth.push_back(10);
    map.region.push_back(p.y() > 40    ? SkinRegion::cranium
                         : p.y() > 0   ? SkinRegion::forehead
                         : p.y() > -40 ? SkinRegion::cheek
                                       : SkinRegion::jaw);
  }
  return map;
}

/// An ellipsoid of a head's size (75 x 110 x 95 mm) with smooth bumps of +-`bump` mm, 30 mm apart,
/// soft below and stiff above.
inline TouchableHead bumpy_head(int n, double bump = 1.0, double tool_radius = 5) {
  TouchableHead head;
  head.skin = unit_sphere(n);
  for (Vec3& p : head.skin.points) {
    const Vec3 on(75 * p.x(), 110 * p.y(), 95 * p.z());
    const double w = 2 * std::numbers::pi / 30;
    const double r = std::sin(w * on.x()) * std::sin(w * on.y()) + std::sin(w * on.z() + 1) * 0.5;
    p = on + bump * r * on.cwiseQuotient(Vec3(75 * 75, 110 * 110, 95 * 95)).normalized();
  }
  head.map = stiffening_map(head.skin, tool_radius, [](const Vec3& p) {
    return 2.0 + 1.2 * std::tanh(-p.y() / 40) + 0.3 * std::sin(p.x() / 15) * std::cos(p.z() / 15);
  });
  return head;
}

/// A sphere with the same curve everywhere: k N/mm up to 5 N in ten steps.
inline TouchableHead even_sphere(int n, double radius, double k, double tool_radius = 5) {
  TouchableHead head;
  head.skin = unit_sphere(n);
  for (Vec3& p : head.skin.points) p *= radius;
  head.map = stiffening_map(head.skin, tool_radius, [](const Vec3&) { return 1.0; });
  for (std::size_t i = 0; i < head.map.displacement.size(); ++i)
    head.map.displacement[i] = head.map.forces[i % 10] / k;
  return head;
}

/// z = height(x, y) on a square of side 2 * half, facing +z, closed below by a box of depth 40 mm
/// unless `open`; the same linear curve k everywhere.
template <class Height>
TouchableHead landscape(double half, int n, double k, Height height, bool open = true) {
  TouchableHead head;
  SurfaceMesh& m = head.skin;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = half * (2.0 * i / n - 1), y = half * (2.0 * j / n - 1);
      m.points.emplace_back(x, y, height(x, y));
    }
  const auto cell = [&](int a, int b, int c, int d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i;
      cell(a, a + 1, a + n + 2, a + n + 1);
    }
  if (!open) {
    const auto top = static_cast<int>(m.points.size());
    for (int p = 0; p < top; ++p) m.points.emplace_back(m.points[p].x(), m.points[p].y(), -40.0);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = top + j * (n + 1) + i;
        cell(a, a + n + 1, a + n + 2, a + 1);
      }
    for (int i = 0; i < n; ++i) {
      const int r = n * (n + 1), c = n + 1;
      cell(i, top + i, top + i + 1, i + 1);
      cell(r + i, r + i + 1, top + r + i + 1, top + r + i);
      cell(i * c, (i + 1) * c, top + (i + 1) * c, top + i * c);
      cell(i * c + n, top + i * c + n, top + (i + 1) * c + n, (i + 1) * c + n);
    }
  }
  head.map = stiffening_map(m, 5, [](const Vec3&) { return 1.0; });
  for (std::size_t i = 0; i < head.map.displacement.size(); ++i)
    head.map.displacement[i] = head.map.forces[i % 10] / k;
  return head;
}

}  // namespace palpate::haptics::scenes
