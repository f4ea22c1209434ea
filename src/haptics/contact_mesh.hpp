// SPDX-License-Identifier: Apache-2.0
// The skin as the tick sees it: welded, oriented, in the order of its tree, with its adjacency.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/surface_mesh.hpp"
#include "haptics/box_tree.hpp"
#include "haptics/triangle.hpp"

namespace palpate::haptics {

/// A point of the surface: what every search returns.
struct SurfacePoint {
  TrianglePoint on{Vec3::Zero(), Vec3::UnitX(), Feature::vertex0};
  std::int32_t triangle = -1;  ///< of ContactMesh; -1 where nothing was found
  double distance2 = std::numeric_limits<double>::infinity();  ///< [mm^2] squared distance

  [[nodiscard]] bool found() const { return triangle >= 0; }
};

/// Points equal to the last bit are one vertex, so that seams of texture maps do not cut the skin;
/// triangles without area are dropped; neighbours are turned the same way round and every piece
/// faces out. All queries are const, re-entrant, and allocate nothing.
struct ContactMesh {
  std::vector<Vec3> points;              ///< [mm]
  std::vector<Vec3> normals;             ///< [-] unit, angle-weighted, one per point
  std::vector<Triangle> triangles;       ///< leaves of the tree, in its order
  std::vector<Triangle> neighbours;      ///< across the edge from corner k to k+1; -1 on a border
  std::vector<std::int32_t> ring_begin;  ///< points + 1; triangles around v are
  std::vector<std::int32_t> ring;        ///< ring[ring_begin[v]] to ring[ring_begin[v + 1] - 1]
  std::vector<std::int32_t> source_triangle;  ///< number in the input mesh
  std::vector<std::int32_t> vertex_of;        ///< input vertex -> point, -1 where unused
  std::vector<std::int32_t> source_vertex;    ///< point -> first input vertex
  std::size_t flipped = 0;                    ///< triangles turned round
  std::size_t degenerate = 0;                 ///< triangles without area, dropped
  std::size_t border_edges = 0;
  BoxTree tree;

  [[nodiscard]] TrianglePoint nearest_on(std::int32_t triangle, const Vec3& p) const {
    const Triangle& t = triangles[static_cast<std::size_t>(triangle)];
    return nearest_on_triangle(p, points[t[0]], points[t[1]], points[t[2]]);
  }
  [[nodiscard]] SurfacePoint measure(std::int32_t triangle, const Vec3& p) const {
    SurfacePoint s;
    s.on = nearest_on(triangle, p);
    s.triangle = triangle;
    s.distance2 = (s.on.point - p).squaredNorm();
    return s;
  }
  /// Unit normal of one triangle.
  [[nodiscard]] Vec3 face_normal(std::int32_t triangle) const;
  /// Normal (not unit) that tells the side of a point nearest to `at`.
  /// @cite Baerentzen & Aanaes 2005, angle-weighted pseudonormal
  [[nodiscard]] Vec3 side_normal(const SurfacePoint& at) const;
  /// Vertex normals blended over the triangle, unit.
  [[nodiscard]] Vec3 blended_normal(const SurfacePoint& at) const;
  [[nodiscard]] bool on_border(const SurfacePoint& at) const;

  /// The nearest point within `radius2`, over the whole surface; ties go to the lower triangle. A
  /// point `known` to lie on the surface (measured from p, or empty) only makes it faster.
  [[nodiscard]] SurfacePoint nearest(const Vec3& p, double radius2,
                                     const SurfacePoint& known = {}) const;
  /// Walks over the surface from `start`, always closer to p, until no triangle around is closer:
  /// the nearest point that a proxy can slide to. At most kLongestWalk triangles.
  [[nodiscard]] SurfacePoint descend(const Vec3& p, const SurfacePoint& start) const;
  static constexpr int kLongestWalk = 256;
};

/// @throws InputError  no triangle with area, or the first defect
[[nodiscard]] ContactMesh make_contact_mesh(const SurfaceMesh& skin);

}  // namespace palpate::haptics
