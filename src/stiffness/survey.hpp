// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of every point before anything is pressed.
#pragma once
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {

/// Step 1 of a sweep alone: depth and status of each point exactly as sweep() finds them
/// (`blended`: there is tissue to press). No forces, so no curves; errors are NaN.
/// @note Same bits for any thread count.
[[nodiscard]] StiffnessMap survey(const HeadSurface& head, const SkullFit& skull,
                                  const SkinPoints& points, const SweepOptions& options = {},
                                  const Progress& progress = {});

}  // namespace palpate::stiffness
