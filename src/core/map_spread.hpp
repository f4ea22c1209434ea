// SPDX-License-Identifier: Apache-2.0
// How far the map may be off.
#pragma once
#include <vector>

namespace palpate {

/// One standard deviation per skin vertex (docs/method/uncertainty.md). Empty vectors: not known.
struct MapSpread {
  std::vector<double> depth;      ///< [mm] of StiffnessMap::depth; NaN where no bone
  std::vector<double> stiffness;  ///< [-] of ln(2 N / u(2 N)); NaN where no curve. The stiffness
                                  ///< lies between k e^-2s and k e^2s in about 95 of 100 heads

  [[nodiscard]] bool empty() const { return depth.empty(); }
};

}  // namespace palpate
