// SPDX-License-Identifier: GPL-3.0-or-later
// The patch test: a linear displacement on the boundary is reproduced inside, on any mesh.
#include <gtest/gtest.h>

#include "fem/equilibrium.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

double worst_error(ElementOrder order, const TissueLaws& law, const Mat3& gradient) {
  TetMesh linear = scenes::cube(3);
  scenes::shake(linear, 0.2, 5);
  const TetMesh mesh = scenes::in_order(linear, order);
  std::vector<HeldNode> held;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (scenes::on_cube_surface(mesh.nodes[n]))
      held.push_back({static_cast<int>(n), gradient * mesh.nodes[n]});
  EquilibriumOptions options;
  options.force_tolerance = 1e-15;
  const Equilibrium e = solve_equilibrium(mesh, law, held, {}, options);
  double worst = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    worst = std::max(worst, (e.displacement[n] - gradient * mesh.nodes[n]).norm());
  return worst / gradient.norm();
}

TEST(PatchTest, LinearFieldIsExact) {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  Mat3 small, large;
  small << 1e-3, 2e-4, -3e-4, 5e-4, -8e-4, 1e-4, 0, 3e-4, 6e-4;
  large << 0.2, 0.1, -0.05, 0.15, -0.2, 0.08, 0, 0.1, 0.1;
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    EXPECT_LE(worst_error(order, linear_elastic(m), small), 1e-10);
    EXPECT_LE(worst_error(order, neo_hookean(m), large), 1e-10);
    EXPECT_LE(worst_error(order, mooney_rivlin(mooney_rivlin_from(m)), large), 1e-10);
    EXPECT_LE(worst_error(order, corotational(m), small), 1e-10);
    EXPECT_LE(worst_error(order, neo_hookean_centred(m), large), 1e-10);
    EXPECT_LE(worst_error(order, linear_elastic_centred(m), small), 1e-10);
  }
}

}  // namespace
}  // namespace palpate::fem
