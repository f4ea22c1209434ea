// SPDX-License-Identifier: GPL-3.0-or-later
// TetGen's text files: .poly in, .node and .ele out (TetGen 1.5 manual, chapter 5).
#pragma once
#include <filesystem>
#include <span>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::tetmesh {

/// A point inside a region, the number its tetrahedra get, and the largest volume they may have.
struct RegionSeed {
  Vec3 point = Vec3::Zero();  ///< [mm]
  int label = 0;
  double max_volume = 0;  ///< [mm^3]
};

/// Surfaces one after the other, coordinates with 17 digits (they read back as the same bits).
void write_poly(const std::filesystem::path& path, std::span<const SurfaceMesh* const> surfaces,
                std::span<const RegionSeed> seeds);

struct TetgenResult {
  std::vector<Vec3> nodes;
  std::vector<Tetrahedron> tets;  ///< det(b-a, c-a, d-a) > 0
  std::vector<int> label;         ///< one per tet
};
/// @throws SolveError  a file is missing, short, or holds anything but what the format says: names
///                     the file and the line
[[nodiscard]] TetgenResult read_tetgen(const std::filesystem::path& node,
                                       const std::filesystem::path& ele);

}  // namespace palpate::tetmesh
