// SPDX-License-Identifier: Apache-2.0
// What the bundled surfaces must be: closed, oriented, one piece, symmetric, free of slivers.
#pragma once
#include <cstddef>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::data_test {

struct Topology {
  std::size_t unpaired_edges = 0;  ///< directed edges without exactly one opposite twin
  std::size_t components = 0;      ///< edge-connected pieces; points without triangle not counted
  std::size_t unused_points = 0;   ///< points in no triangle
  std::size_t pinched_points = 0;  ///< points whose triangles form more than one fan
  long euler = 0;                  ///< V - E + F; 2 for a sphere
};
[[nodiscard]] Topology topology(const SurfaceMesh& mesh);

/// Lengths of all edges, ascending [mm].
[[nodiscard]] std::vector<double> edge_lengths(const SurfaceMesh& mesh);

/// Smallest quality 4 sqrt(3) area / (sum of squared edges) over the triangles; 1 for equilateral.
[[nodiscard]] double worst_quality(const SurfaceMesh& mesh);

/// Largest distance from a point's mirror image (x -> -x) to the nearest point of the mesh [mm];
/// looks no further than `reach`.
[[nodiscard]] double mirror_error(const SurfaceMesh& mesh, double reach);

/// Distance from a point to the nearest triangle [mm].
[[nodiscard]] double distance_to(const SurfaceMesh& mesh, const Vec3& point);

/// Whether a point lies inside a closed mesh, by its winding number.
[[nodiscard]] bool inside(const SurfaceMesh& mesh, const Vec3& point);

}  // namespace palpate::data_test
