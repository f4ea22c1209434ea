// SPDX-License-Identifier: Apache-2.0
// The volume between skin and skull.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/types.hpp"

namespace palpate {

enum class TissueLabel : std::uint8_t { flesh = 1, bone = 2 };

/// Linear tetrahedra in two layers, [mm]. The first `skin_points` nodes are the working skin's
/// points, unmoved and in order.
struct TissueMesh {
  std::vector<Vec3> nodes;
  std::vector<Tetrahedron> tets;   ///< positive volumes
  std::vector<TissueLabel> label;  ///< one per tet
  std::size_t skin_points = 0;
  std::vector<std::uint8_t> held;         ///< one per node: 1 where bone or an organ holds it
  std::map<std::string, double> quality;  ///< named figures, units in the names
};

}  // namespace palpate
