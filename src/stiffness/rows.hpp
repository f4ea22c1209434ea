// SPDX-License-Identifier: GPL-3.0-or-later
// What the map says at one spot.
#pragma once
#include <limits>
#include <vector>

#include "core/stiffness_map.hpp"

namespace palpate::stiffness {

/// One spot's result, however it came about.
struct Row {
  VertexStatus status = VertexStatus::no_bone;
  SolveMethod method = SolveMethod::none;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< [-] of the travel
  std::vector<double> travel;                               ///< [mm] one per force; empty: none
  std::vector<double> dent;  ///< [-] one per dent radius; empty: none known
};

}  // namespace palpate::stiffness
