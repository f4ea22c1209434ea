// SPDX-License-Identifier: Apache-2.0
// A triangle surface: points and corner indices, nothing else.
#pragma once
#include <optional>
#include <string>
#include <utility>

#include "core/types.hpp"

namespace palpate {

/// Triangle soup or mesh. Unit: [mm] unless the holder says otherwise.
struct SurfaceMesh {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;

  [[nodiscard]] bool empty() const { return points.empty() || triangles.empty(); }
};

/// Axis-aligned box; `low` > `high` for an empty set of points.
struct Box {
  Vec3 low;
  Vec3 high;
  [[nodiscard]] Vec3 size() const { return high - low; }
  [[nodiscard]] Vec3 center() const { return 0.5 * (low + high); }
};
[[nodiscard]] Box bounding_box(const std::vector<Vec3>& points);

/// Area-weighted unit normals, one per triangle [-]; zero for a degenerate triangle.
[[nodiscard]] std::vector<Vec3> triangle_normals(const SurfaceMesh& mesh);
/// Angle-weighted unit normals, one per point [-]; zero where no triangle touches.
/// @cite Baerentzen & Aanaes 2005, "Signed distance computation using the angle weighted
/// pseudonormal"
[[nodiscard]] std::vector<Vec3> vertex_normals(const SurfaceMesh& mesh);
/// Signed volume [mm^3], positive for a closed mesh whose normals point out.
[[nodiscard]] double signed_volume(const SurfaceMesh& mesh);
/// The same mesh with every point mapped to rotation * p + translation.
[[nodiscard]] SurfaceMesh transformed(SurfaceMesh mesh, const Mat3& linear,
                                      const Vec3& translation);
/// Describes the first defect (index out of range, NaN or infinite coordinate); nothing for a
/// valid mesh.
[[nodiscard]] std::optional<std::string> first_defect(const SurfaceMesh& mesh);

}  // namespace palpate
