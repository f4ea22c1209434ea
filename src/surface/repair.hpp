// SPDX-License-Identifier: GPL-3.0-or-later
// From a raw scan to a closed, oriented, evenly triangulated working surface, with a report.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "core/surface_mesh.hpp"

namespace palpate::surface {

struct RepairOptions {
  double target_edge = 3.0;                ///< [mm] edge of the working mesh; 1 to 10
  std::size_t decimate_above = 2'000'000;  ///< [triangles] larger scans are thinned first
  std::size_t refuse_above = 20'000'000;   ///< [triangles] larger scans are refused
};

/// What was found and done. Counts are of the scan's elements.
struct RepairReport {
  std::size_t duplicate_points = 0;
  std::size_t duplicate_faces = 0;
  std::size_t degenerate_faces = 0;
  std::size_t nonmanifold_spots = 0;
  std::size_t components = 0;         ///< found; the largest (by area) is kept
  std::size_t dropped_triangles = 0;  ///< of the other components
  bool winding_inverted = false;
  std::size_t holes_filled = 0;
  double largest_hole_mm = 0;       ///< [mm] perimeter
  std::size_t pockets_closed = 0;   ///< eye sockets, mouth, nostrils: see pockets.hpp
  std::size_t decimated_from = 0;   ///< [triangles] 0 where nothing was thinned
  bool wrapped = false;             ///< alpha wrap was needed
  double deviation_p95_mm = 0;      ///< [mm] scan vertices to working surface, 95th percentile over
                                    ///< those that are not in or at the rim of a closed place
  double deviation_all_p95_mm = 0;  ///< [mm] the same over all vertices of the kept piece
  std::vector<std::string> lines;   ///< the same, one sentence each, for people
};

struct WorkingSurface {
  SurfaceMesh mesh;                  ///< closed 2-manifold, normals out, no self-intersection
  std::vector<std::uint8_t> filled;  ///< one per point: 1 where a hole was closed (no scan nearby)
  RepairReport report;
};

/// Steps: soup repair, orientation, largest component, decimation, hole filling, isotropic
/// remeshing, closing of pockets, removal of self-intersections; alpha wrap only where these fail.
/// docs/method/repair.md has the reasons.
/// @param scan  [mm], any triangle soup
/// @throws InputError  empty, NaN, too large, or nothing that closes into a volume
/// @note Deterministic; same bits for any thread count.
[[nodiscard]] WorkingSurface make_working_surface(const SurfaceMesh& scan,
                                                  const RepairOptions& options = {},
                                                  const Progress& progress = {});

}  // namespace palpate::surface
