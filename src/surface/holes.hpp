// SPDX-License-Identifier: GPL-3.0-or-later
// Closes border loops with smooth membranes.
#pragma once
#include <cstddef>

#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"

namespace palpate::surface {

struct HoleStatistics {
  std::size_t filled = 0;
  double largest_perimeter = 0;  ///< [mm]
};

/// Closes every border loop: least-area triangulation of the loop, refined to `edge` [mm], relaxed
/// to a membrane (a soap film on the loop). New faces are caps or covers by the
/// length of their rim. The mesh is closed after it.
/// @note Deterministic. O(n) in the loop's length beyond a constant.
HoleStatistics fill_holes(CornerMesh& mesh, double edge, const Progress& progress);

}  // namespace palpate::surface
