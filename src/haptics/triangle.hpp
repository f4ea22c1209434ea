// SPDX-License-Identifier: Apache-2.0
// The point of a triangle nearest to a given point, inline because the tick calls it for each
// candidate.
#pragma once
#include <cstdint>

#include "core/types.hpp"

namespace palpate::haptics {

/// Which part of a triangle a nearest point lies on; `edge0` runs from corner 0 to corner 1.
enum class Feature : std::uint8_t { face, edge0, edge1, edge2, vertex0, vertex1, vertex2 };
[[nodiscard]] constexpr bool is_edge(Feature f) {
  return f >= Feature::edge0 && f < Feature::vertex0;
}
[[nodiscard]] constexpr bool is_vertex(Feature f) {
  return f >= Feature::vertex0;
}
/// Number of the edge or corner, 0 to 2.
[[nodiscard]] constexpr int which(Feature f) {
  return static_cast<int>(f) - static_cast<int>(is_vertex(f) ? Feature::vertex0 : Feature::edge0);
}

struct TrianglePoint {
  Vec3 point;        ///< [mm]
  Vec3 barycentric;  ///< [-] sums to 1
  Feature feature;
};

/// @cite Ericson, Real-Time Collision Detection (2005), section 5.1.5: the Voronoi region of p
/// decides the feature; no division before the region is known. The face comes first: it is where a
/// tool mostly rests, and the other regions take their branches from the same numbers.
[[nodiscard]] inline TrianglePoint nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                                       const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  const auto on_face = [&]() -> TrianglePoint {
    const double scale = 1 / (va + vb + vc);
    const double v = vb * scale;
    const double w = vc * scale;
    return {a + v * ab + w * ac, Vec3(1 - v - w, v, w), Feature::face};
  };
  if (va > 0 && vb > 0 && vc > 0) return on_face();
  if (d1 <= 0 && d2 <= 0) return {a, Vec3::UnitX(), Feature::vertex0};
  if (d3 >= 0 && d4 <= d3) return {b, Vec3::UnitY(), Feature::vertex1};
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {a + t * ab, Vec3(1 - t, t, 0), Feature::edge0};
  }
  if (d6 >= 0 && d5 <= d6) return {c, Vec3::UnitZ(), Feature::vertex2};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {a + t * ac, Vec3(1 - t, 0, t), Feature::edge2};
  }
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + t * (c - b), Vec3(0, 1 - t, t), Feature::edge1};
  }
  return on_face();  // within rounding of an edge
}

}  // namespace palpate::haptics
