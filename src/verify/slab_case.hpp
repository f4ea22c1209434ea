// SPDX-License-Identifier: GPL-3.0-or-later
// A 12 mm slab of flesh under a smooth patch of pressure: what every solver gets, node by node and
// force by force the same.
#pragma once
#include "fem/loads.hpp"
#include "verify/slab.hpp"

namespace palpate::verify {

struct SlabCase {
  Slab slab;
  fem::Topology topology;            ///< without travel
  std::vector<fem::NodalLoad> unit;  ///< of 1 N, patch radius 8 mm
  std::vector<double> forces;        ///< [N] ascending
};
[[nodiscard]] SlabCase slab_case(fem::ElementOrder order, std::vector<double> forces);

using Field = std::vector<Vec3>;  ///< [mm] one per node
struct SlabFields {
  std::vector<Field> at;    ///< one per load that converged
  std::string failure;      ///< "" when all did
  double reached = 0;       ///< [N] largest load at which an equilibrium was found
  int first_inverted = -1;  ///< index of the first load with an element inside out
};
[[nodiscard]] SlabFields solve_ours(const SlabCase& scene, const fem::TissueLaws& laws);

/// Largest difference of a node over the largest displacement of `reference`.
[[nodiscard]] double field_difference(const Field& ours, const Field& reference);

}  // namespace palpate::verify
