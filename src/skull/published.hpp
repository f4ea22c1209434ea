// SPDX-License-Identifier: GPL-3.0-or-later
// The published fit: hierarchical weighted FFD (source 4.3, Algorithms 1 and 2).
#pragma once
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "skull/ffd.hpp"
#include "skull/fit.hpp"
#include "surface/query.hpp"

namespace palpate::skull {

/// Algorithm 1: a control point is heavy where the head lies within the circumscribed sphere of a
/// lattice cell around it.
void weigh_control_points(BernsteinLattice& lattice, const surface::SurfaceQuery& head,
                          const PublishedFitOptions& options);

/// 1 on the region; outside it falls linearly with the distance to the region's nearest point, from
/// `outside_near` at 0 to `outside_far` at `outside_reach` and stays there.
[[nodiscard]] std::vector<double> region_weights(const SurfaceMesh& mesh,
                                                 const std::vector<SkullRegion>& region,
                                                 SkullRegion active,
                                                 const PublishedFitOptions& options);

/// Placement and fit as published; no target depth, so bone is drawn to the skin itself.
/// @throws InputError  a landmark or a region is missing
[[nodiscard]] SkullFit fit_published(const HeadSurface& head, const SkullTemplate& skull,
                                     const FitOptions& options, const Progress& progress);

}  // namespace palpate::skull
