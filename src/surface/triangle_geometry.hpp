// SPDX-License-Identifier: GPL-3.0-or-later
// One triangle against one point or one ray, in double precision; degenerate triangles included.
#pragma once
#include <optional>

#include "core/types.hpp"

namespace palpate::surface {

/// Which part of a triangle a point of it lies on. Edge k joins corners k and k+1 (mod 3).
enum class Feature : std::uint8_t { face, edge0, edge1, edge2, vertex0, vertex1, vertex2 };

struct TrianglePoint {
  Vec3 point = Vec3::Zero();        ///< same unit as the input
  Vec3 barycentric = Vec3::Zero();  ///< [-] >= 0, sum 1
  Feature feature = Feature::face;
};
/// Closest point of the triangle (a, b, c) to p, by Voronoi regions.
/// @cite Ericson 2005, "Real-Time Collision Detection", 5.1.5
[[nodiscard]] TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                                const Vec3& c);

struct TriangleCrossing {
  double t = 0;                     ///< distance along the unit direction
  Vec3 barycentric = Vec3::Zero();  ///< [-] clamped to the triangle, sum 1
};
/// Where the line origin + t * direction meets the triangle's plane. The caller knows that the ray
/// meets the triangle to within rounding: coordinates just outside are clamped. Nothing for a
/// triangle without area or parallel to the line.
[[nodiscard]] std::optional<TriangleCrossing> cross_plane(const Vec3& origin, const Vec3& direction,
                                                          const Vec3& a, const Vec3& b,
                                                          const Vec3& c);

}  // namespace palpate::surface
