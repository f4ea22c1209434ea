// SPDX-License-Identifier: GPL-3.0-or-later
// Travel of a sphere of radius 8 mm on bonded slabs of flesh (neo-Hookean, E = 45.658 kPa, nu =
// 0.43) with a patch fine and wide enough to judge the default one by; recomputed by `bench_sweep
// --refined`.
#pragma once
#include <array>
#include <vector>

#include "stiffness/patch_template.hpp"

namespace palpate::stiffness {

inline const std::vector<double> kSlabForces = {0.5, 1, 2, 3.5, 5};  // [N]
struct RefinedSlab {
  double thickness;              // [mm]
  std::array<double, 5> travel;  // [mm]
};
/// 241 columns, four layers, 85 mm; rim held.
inline PatchRule refined_rule() {
  PatchRule rule;
  rule.rings = {{1.5, 6}, {3, 12},  {4.5, 18}, {6, 24},  {8, 24},  {10, 24}, {13, 24},
                {17, 24}, {22, 18}, {31, 18},  {43, 18}, {60, 18}, {85, 12}};
  rule.layers = 4;
  rule.touch_radius = 14;
  rule.hold_rim = true;
  return rule;
}
inline const std::array<RefinedSlab, 4> kRefinedSlabs = {{
    {3, {0.81643, 1.13580, 1.56863, 1.98171, 2.27346}},
    {8, {1.27801, 1.89444, 2.76405, 3.74905, 4.52903}},
    {15, {1.50227, 2.30891, 3.53587, 4.97542, 6.22117}},
    {25, {1.61502, 2.53369, 3.98310, 5.73764, 7.32683}},
}};

}  // namespace palpate::stiffness
