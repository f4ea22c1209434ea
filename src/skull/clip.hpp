// SPDX-License-Identifier: GPL-3.0-or-later
// Cutting the closed skull: where the scan ends, and between its teeth. The only file that uses
// CGAL here.
#pragma once
#include <cstddef>
#include <vector>

#include "core/surface_mesh.hpp"
#include "registration/cut.hpp"

namespace palpate::skull {

struct Clipped {
  SurfaceMesh mesh;                  ///< closed
  std::vector<std::int32_t> origin;  ///< per point: the nearest point of the mesh that came in
  double removed_mm3 = 0;
};

/// Keeps what lies at normal . p < offset of every plane, closes the cuts with triangles of
/// `edge` [mm] and drops splinters below 1 cm^3.
/// @throws SolveError  the mesh intersects itself at a cut, or nothing is left
[[nodiscard]] Clipped clip_closed(const SurfaceMesh& mesh,
                                  const std::vector<registration::CutPlane>& planes, double edge);

/// What of the mesh lies outside a convex tool; the cut is closed with triangles of `edge` [mm].
/// @param tool  closed, oriented outwards, convex
/// @throws SolveError  the mesh is open, or intersects itself
[[nodiscard]] Clipped carve(const SurfaceMesh& mesh, const SurfaceMesh& tool, double edge);

/// Pairs of triangles that intersect without sharing a corner.
[[nodiscard]] std::size_t count_self_intersections(const SurfaceMesh& mesh);

}  // namespace palpate::skull
