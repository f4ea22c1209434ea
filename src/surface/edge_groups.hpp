// SPDX-License-Identifier: GPL-3.0-or-later
// The sides of triangles, grouped by the edge that they lie on.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.hpp"

namespace palpate::surface {

/// Side k of triangle t is half-edge 3 t + k and runs from corner k to corner k+1 (mod 3).
/// Calls `visit(std::span<const std::int32_t> halfedges)` once per undirected edge, edges in
/// ascending order of their vertices, half-edges ascending. O(n) time and memory.
template <class Visit>
void for_each_edge(const std::vector<Triangle>& triangles, std::size_t points, Visit&& visit) {
  struct Side {
    std::int32_t high, halfedge;
    bool operator<(const Side& o) const {
      return high < o.high || (high == o.high && halfedge < o.halfedge);
    }
  };
  std::vector<std::size_t> start(points + 1, 0);
  const auto ends = [&](std::size_t h) {
    const Triangle& t = triangles[h / 3];
    return std::minmax(t[h % 3], t[(h + 1) % 3]);
  };
  const std::size_t count = 3 * triangles.size();
  for (std::size_t h = 0; h < count; ++h) ++start[ends(h).first + 1];
  for (std::size_t v = 0; v < points; ++v) start[v + 1] += start[v];
  std::vector<Side> sides(count);
  std::vector<std::size_t> fill(start.begin(), start.end() - 1);
  for (std::size_t h = 0; h < count; ++h) {
    const auto [low, high] = ends(h);
    sides[fill[low]++] = {high, static_cast<std::int32_t>(h)};
  }
  std::vector<std::int32_t> group;
  for (std::size_t v = 0; v < points; ++v) {
    const auto first = sides.begin() + static_cast<std::ptrdiff_t>(start[v]);
    const auto last = sides.begin() + static_cast<std::ptrdiff_t>(start[v + 1]);
    std::sort(first, last);
    for (auto it = first; it != last;) {
      group.clear();
      const std::int32_t high = it->high;
      for (; it != last && it->high == high; ++it) group.push_back(it->halfedge);
      visit(std::span<const std::int32_t>(group));
    }
  }
}

}  // namespace palpate::surface
