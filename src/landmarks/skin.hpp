// SPDX-License-Identifier: GPL-3.0-or-later
// A working surface with what every step of the detection asks of it.
#pragma once
#include <vector>

#include "core/surface_mesh.hpp"
#include "surface/curvature.hpp"
#include "surface/point_tree.hpp"
#include "surface/query.hpp"

namespace palpate::landmarks {

/// Built once per detection; const and re-entrant afterwards. Keeps a reference to the mesh.
struct Skin {
  const SurfaceMesh& mesh;
  std::vector<Vec3> normals;                  ///< [-] outward, one per point
  surface::PointTree tree;                    ///< over the points
  surface::SurfaceQuery query;                ///< distances and rays
  std::vector<surface::Curvature> curvature;  ///< [1/mm] at kDomeRadius

  explicit Skin(const SurfaceMesh& m);
};

/// [mm] radius of the patches whose curvature finds domes: a nose tip bends with about this radius,
/// while lips, lids and scan noise are smaller.
inline constexpr double kDomeRadius = 10;

}  // namespace palpate::landmarks
