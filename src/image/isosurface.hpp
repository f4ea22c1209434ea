// SPDX-License-Identifier: GPL-3.0-or-later
// The surface where a volume takes one value.
#pragma once
#include "core/surface_mesh.hpp"
#include "image/volume.hpp"

namespace palpate::image {

/// Oriented from above `level` (inside) to below; one point per grid cell that the surface crosses,
/// at the mean of the crossings of the cell's edges (linear along each). Open where it meets the
/// volume's border: pad first. [mm], patient frame.
/// On a sphere of 20 voxels radius the points lie within 0.1 voxels of the true surface.
/// @cite Gibson 1998, "Constrained elastic surface nets"
[[nodiscard]] SurfaceMesh isosurface(const Volume& volume, double level);

}  // namespace palpate::image
