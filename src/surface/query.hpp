// SPDX-License-Identifier: GPL-3.0-or-later
// Distance, side and ray queries against a triangle surface.
#pragma once
#include <memory>
#include <optional>
#include <utility>

#include "core/surface_mesh.hpp"

namespace palpate::surface {

struct ClosestPoint {
  Vec3 point = Vec3::Zero();        ///< [mm] on the surface
  Vec3 barycentric = Vec3::Zero();  ///< [-] of `triangle`
  std::int32_t triangle = -1;       ///< -1 where nothing lies within the search radius
  double distance = 0;              ///< [mm] >= 0; infinite where nothing was found
};
struct RayHit {
  double distance = 0;              ///< [mm] along the unit direction
  Vec3 point = Vec3::Zero();        ///< [mm]
  Vec3 barycentric = Vec3::Zero();  ///< [-]
  std::int32_t triangle = -1;
};

/// A tree over a mesh, built once. The tree finds candidates in single precision; distances and
/// points are recomputed in double. Queries are const, re-entrant and allocate nothing.
class SurfaceQuery {
 public:
  /// Copies the mesh. @throws InputError for an empty mesh, naming the first defect otherwise
  explicit SurfaceQuery(const SurfaceMesh& mesh);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  [[nodiscard]] ClosestPoint closest(const Vec3& p, double max_distance = 1e9) const;
  /// Distance with sign [mm], negative inside; meaningful for a closed, outward-oriented mesh.
  /// Sign from the angle-weighted pseudonormal (Baerentzen & Aanaes 2005).
  [[nodiscard]] double signed_distance(const Vec3& p) const;
  /// Both in one query: the nearest point, and the distance with sign [mm].
  [[nodiscard]] std::pair<ClosestPoint, double> closest_with_sign(const Vec3& p) const;
  /// First hit beyond `min_distance` [mm] along the unit vector `direction`.
  [[nodiscard]] std::optional<RayHit> cast(const Vec3& origin, const Vec3& direction,
                                           double max_distance = 1e9,
                                           double min_distance = 0) const;
  /// Whether anything lies beyond `min_distance` [mm] along the unit vector. Single precision, for
  /// votes over many rays: hits within about 1e-6 of the mesh's size of an end may go either way.
  [[nodiscard]] bool blocked(const Vec3& origin, const Vec3& direction,
                             double min_distance = 0) const;
  [[nodiscard]] const SurfaceMesh& mesh() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace palpate::surface
