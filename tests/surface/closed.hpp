// SPDX-License-Identifier: GPL-3.0-or-later
// What every working surface must be.
#pragma once
#include <gtest/gtest.h>

#include "surface/edge_groups.hpp"
#include "surface/intersections.hpp"

namespace palpate::surface {

/// Closed oriented 2-manifold (each edge once each way, one fan per point), without
/// self-intersections, normals out.
inline void expect_clean(const SurfaceMesh& m) {
  ASSERT_FALSE(m.empty());
  std::size_t bad = 0;
  for_each_edge(m.triangles, m.points.size(), [&](std::span<const std::int32_t> sides) {
    const auto start = [&](std::int32_t h) { return m.triangles[h / 3][h % 3]; };
    if (sides.size() != 2 || start(sides[0]) == start(sides[1])) ++bad;
  });
  EXPECT_EQ(bad, 0u) << "edges that are not shared by two faces, one each way";
  // With closed edges, one fan per point means: the links' edges make one cycle. Count faces per
  // fan by walking.
  std::vector<std::map<std::int32_t, std::int32_t>> link(m.points.size());
  for (const auto& [a, b, c] : m.triangles) link[a][b] = c, link[b][c] = a, link[c][a] = b;
  std::size_t split = 0;
  for (const auto& l : link) {
    if (l.empty()) {
      ++split;
      continue;
    }
    std::size_t steps = 0;
    std::int32_t v = l.begin()->first;
    do {
      const auto it = l.find(v);
      if (it == l.end()) break;
      v = it->second;
      ++steps;
    } while (v != l.begin()->first && steps <= l.size());
    if (steps != l.size()) ++split;
  }
  EXPECT_EQ(split, 0u) << "points without a face or with several fans";
  EXPECT_EQ(self_intersections(m).size(), 0u);
  EXPECT_GT(signed_volume(m), 0);
}

inline double area(const SurfaceMesh& m) {
  double sum = 0;
  for (const auto& [a, b, c] : m.triangles)
    sum += 0.5 * (m.points[b] - m.points[a]).cross(m.points[c] - m.points[a]).norm();
  return sum;
}

}  // namespace palpate::surface
