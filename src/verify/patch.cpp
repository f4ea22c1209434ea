// SPDX-License-Identifier: GPL-3.0-or-later
// The patch test: a linear displacement on the boundary is reproduced inside, on an uneven mesh.
#include <fmt/format.h>

#include "core/error.hpp"
#include "fem/equilibrium.hpp"
#include "verify/blocks.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;

double patch_error(ElementOrder order, const TissueLaws& laws, const Mat3& gradient) {
  TetMesh linear = cube(3);
  shake(linear, 0.2, 5);
  const TetMesh mesh = in_order(linear, order);
  std::vector<HeldNode> held;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (on_cube_surface(mesh.nodes[n]))
      held.push_back({static_cast<int>(n), gradient * mesh.nodes[n]});
  EquilibriumOptions tight;
  tight.force_tolerance = 1e-15;
  const Equilibrium e = solve_equilibrium(mesh, laws, held, {}, tight);
  double worst = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    worst = std::max(worst, (e.displacement[n] - gradient * mesh.nodes[n]).norm());
  return worst / gradient.norm();
}

}  // namespace

Section check_patch(const VerifyOptions&) {
  Section s{
      "patch", "Patch test",
      "A displacement linear in space is put on the surface of a cube with shaken inner nodes; "
      "the largest error of an inner node, relative to the gradient. Large strains where the "
      "law is made for them."};
  Mat3 small, large;
  small << 1e-3, 2e-4, -3e-4, 5e-4, -8e-4, 1e-4, 0, 3e-4, 6e-4;
  large << 0.2, 0.1, -0.05, 0.15, -0.2, 0.08, 0, 0.1, 0.1;
  const LameModuli m = flesh_moduli();
  const std::vector<std::tuple<const char*, TissueLaws, Mat3>> cases = {
      {"small-strain linear", linear_elastic(m), small},
      {"corotational", corotational(m), small},
      {"neo-Hookean", neo_hookean(m), large},
      {"Mooney-Rivlin", mooney_rivlin(mooney_rivlin_from(m)), large}};
  report::Page::Table table{{"law", "4 nodes", "10 nodes"}, {}};
  double worst[2] = {0, 0};
  for (const auto& [law, laws, gradient] : cases) {
    const double p1 = patch_error(ElementOrder::linear, laws, gradient),
                 p2 = patch_error(ElementOrder::quadratic, laws, gradient);
    table.rows.push_back({law, fmt::format("{:.1e}", p1), fmt::format("{:.1e}", p2)});
    worst[0] = std::max(worst[0], p1), worst[1] = std::max(worst[1], p2);
  }
  s.figures = {at_most("patch test, 4-node elements", worst[0], 1e-10),
               at_most("patch test, 10-node elements", worst[1], 1e-10)};
  s.tables = {table};
  return s;
}

}  // namespace palpate::verify
