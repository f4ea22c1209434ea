// SPDX-License-Identifier: GPL-3.0-or-later
// The default patch against refined ones, and the contact's penalty. (Exact solutions:
// tests/verify.)
#include "fem/press.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../stiffness/refined_slab.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/site.hpp"

namespace palpate::fem {
namespace {

using namespace stiffness;

std::vector<Vec3> slab(const PatchTemplate& t, double thickness, double first_layer) {
  PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), thickness);
  return patch_nodes(t, g, first_layer);
}

/// Largest relative error of the travel against the refined slab at loads from 0.5 to 5 N.
double slab_error(const RefinedSlab& reference, double penalty) {
  const PatchTemplate t = make_template(rule_for_depth(reference.thickness, 8));
  Cholesky cholesky(t.topology.pattern);
  const SiteCurve c =
      press_site(t, slab(t, reference.thickness, t.rule.first_layer),
                 neo_hookean(lame_moduli(0.045658, 0.43)), {8, penalty}, kSlabForces, cholesky);
  double worst = 0;
  for (std::size_t i = 0; i < kSlabForces.size(); ++i)
    worst = std::max(worst, std::abs(c.travel.at(i) / reference.travel[i] - 1));
  return worst;
}

TEST(Press, TheDefaultPatchIsWithinItsStatedError) {
  for (const RefinedSlab& reference : kRefinedSlabs) {
    const double error = slab_error(reference, default_penalty(0.045658, 8));
    std::printf("slab of %g mm: %.2f %%\n", reference.thickness, 100 * error);
    EXPECT_LT(error, 0.02) << reference.thickness;
  }
}

TEST(Press, TheContactsPenaltyIsCorrectedFor) {
  const PatchTemplate t = make_template(rule_for_depth(8, 8));
  Cholesky cholesky(t.topology.pattern);
  std::vector<std::vector<double>> travel;
  for (const double factor : {1.0, 20.0})
    travel.push_back(press_site(t, slab(t, 4, t.rule.first_layer),
                                neo_hookean(lame_moduli(0.045658, 0.43)),
                                {8, factor * default_penalty(0.045658, 8)}, kSlabForces, cholesky)
                         .travel);
  for (std::size_t i = 0; i < kSlabForces.size(); ++i)
    EXPECT_NEAR(travel[0].at(i) / travel[1].at(i), 1, 0.004);
}

}  // namespace
}  // namespace palpate::fem
