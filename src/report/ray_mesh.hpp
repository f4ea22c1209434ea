// SPDX-License-Identifier: GPL-3.0-or-later
// One mesh for the ray caster: tree, normals, and how much sky each point sees.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::report {

struct MeshHit {
  double distance = 0;  ///< [mm] along the unit direction
  std::int32_t triangle = -1;
  Vec3 barycentric = Vec3::Zero();  ///< [-]
};

class RayMesh {
 public:
  /// @throws InputError  names the first bad index or coordinate
  explicit RayMesh(SurfaceMesh mesh);
  ~RayMesh();
  RayMesh(RayMesh&&) noexcept;
  RayMesh& operator=(RayMesh&&) noexcept;

  /// First hit farther than `from` [mm]; the same spot is not found twice.
  [[nodiscard]] std::optional<MeshHit> cast(const Vec3& origin, const Vec3& direction,
                                            double from) const;
  [[nodiscard]] Vec3 normal(const MeshHit& hit) const;     ///< smooth, unit, outward
  [[nodiscard]] Vec3 side(const MeshHit& hit) const;       ///< the triangle's own, unit, outward
  [[nodiscard]] double ambient(const MeshHit& hit) const;  ///< [-] 0 (hollow) to 1 (open)
  [[nodiscard]] const SurfaceMesh& surface() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace palpate::report
