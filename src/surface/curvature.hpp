// SPDX-License-Identifier: GPL-3.0-or-later
// Curvature from local quadric fits in the tangent frame.
#pragma once
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::surface {

/// Signs: a sphere of radius r with outward normals has mean = -1/r and gaussian = 1/r^2, so that a
/// peak has mean < 0 and a pit mean > 0 (Besl & Jain).
struct Curvature {
  double gaussian = 0;                ///< [1/mm^2]
  double mean = 0;                    ///< [1/mm]
  double k_min = 0;                   ///< [1/mm] smaller principal curvature, same sign convention
  double k_max = 0;                   ///< [1/mm] larger principal curvature
  Vec3 direction_max = Vec3::Zero();  ///< [-] unit tangent of k_max
};

/// Quadric z = a0 y^2 + a1 y + a2 x^2 + a3 x + a4 + a5 xy in each point's tangent frame over its
/// `neighbours` nearest points (source 4.2.1 with the mixed term), curvature from the fundamental
/// forms.
[[nodiscard]] std::vector<Curvature> curvature_by_neighbours(const SurfaceMesh& mesh,
                                                             int neighbours = 50);
/// The same over all points within `radius` [mm] (at least 12 are used).
[[nodiscard]] std::vector<Curvature> curvature_by_radius(const SurfaceMesh& mesh, double radius);

}  // namespace palpate::surface
