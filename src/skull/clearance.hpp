// SPDX-License-Identifier: GPL-3.0-or-later
// The last millimetres: no bone outside the skin or closer to it than the clearance.
#pragma once
#include <vector>

#include "core/progress.hpp"
#include "skull/skin_field.hpp"

namespace palpate::skull {

struct ClearanceOptions {
  double clearance = 2.5;    ///< [mm] > 0
  double margin = 0.05;      ///< [mm] on top, so that rounding cannot undercut it
  double reach = 12;         ///< [mm] over which a push fades; a cheekbone's thickness
  double least_reach = 1.5;  ///< [mm] reach is narrowed down to this where skin lies on both sides
  int rounds_per_reach = 25;
};

struct ClearanceReport {
  std::size_t pushed = 0;     ///< points that were too close at first
  double largest_push = 0;    ///< [mm] longest way of a point
  std::size_t remaining = 0;  ///< points still too close; 0 on success
};

/// Moves `points` inwards where some lie outside the skin or within the clearance. Each round is a
/// smooth motion of space (a weighted mean of the pushes that fades with distance) whose steps are
/// short against its reach, so it neither folds nor lets two faces of a thin bone meet. `riders` go
/// along without being looked at (landmarks).
/// @note Deterministic.
ClearanceReport keep_clear(std::vector<Vec3>& points, std::vector<Vec3>& riders,
                           const SkinField& skin, const ClearanceOptions& options,
                           const Progress& progress);

}  // namespace palpate::skull
