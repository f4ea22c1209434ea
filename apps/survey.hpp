// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit alone tells of the user's vertices.
#pragma once
#include "apps/pipeline.hpp"

namespace palpate::app {

/// [mm] from each of the user's vertices to the bone, as make_map() would put it into the map; NaN
/// where there is none.
[[nodiscard]] std::vector<double> depth_below(const LocatedHead& located, const SkullFit& skull,
                                              const PipelineOptions& options,
                                              const Progress& progress);

}  // namespace palpate::app
