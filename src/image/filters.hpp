// SPDX-License-Identifier: GPL-3.0-or-later
// What is done to a volume before a surface is taken from it.
#pragma once
#include <cstdint>
#include <vector>

#include "image/volume.hpp"

namespace palpate::image {

/// Gaussian of standard deviation `sigma` [mm] along each axis; nothing for 0. The border counts as
/// going on.
void smooth(Volume& volume, double sigma);

/// Every n-th voxel along each axis, n the largest that leaves voxels of at most `edge` [mm].
[[nodiscard]] Volume coarsened(const Volume& volume, double edge);

/// One more voxel of `value` on each side, so that surfaces close where the volume ends.
[[nodiscard]] Volume padded(const Volume& volume, float value);

/// Face-connected components of the voxels where mask is not 0. Component numbers count from 1 in
/// the order of the first voxel; 0 outside the mask.
struct Components {
  std::vector<std::int32_t> of;       ///< per voxel
  std::vector<std::size_t> size;      ///< voxels of component c at [c - 1]
  std::vector<std::uint8_t> at_edge;  ///< whether component c touches the volume's border
};
[[nodiscard]] Components components(const Volume& grid, const std::vector<std::uint8_t>& mask);

}  // namespace palpate::image
