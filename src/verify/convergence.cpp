// SPDX-License-Identifier: GPL-3.0-or-later
// Order of convergence against a manufactured solution: u = a sin(pi x) sin(pi y) sin(pi z) (1, 2,
// -1) on the unit cube, zero on its surface, with the body force that makes it an equilibrium of
// the neo-Hookean law: -f = div P(F(x)), by differences of the exact stress.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fem/equilibrium.hpp"
#include "verify/blocks.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;
using std::numbers::pi;
constexpr double kAmplitude = 0.03;
const Vec3 kDirection(1, 2, -1);

Vec3 exact(const Vec3& p) {
  return kAmplitude * std::sin(pi * p.x()) * std::sin(pi * p.y()) * std::sin(pi * p.z()) *
         kDirection;
}

Mat3 exact_gradient(const Vec3& p) {
  const Vec3 s = (pi * p).array().sin(), c = (pi * p).array().cos();
  const Vec3 g = pi * Vec3(c.x() * s.y() * s.z(), s.x() * c.y() * s.z(), s.x() * s.y() * c.z());
  return Mat3::Identity() + kAmplitude * kDirection * g.transpose();
}

Vec3 body_force(const EnergyDensity& law, const Vec3& p) {
  constexpr double h = 1e-3;
  Vec3 f = Vec3::Zero();
  for (int j = 0; j < 3; ++j) {
    const auto stress = [&](double t) -> Vec3 {
      return law.stress(exact_gradient(p + t * h * Vec3::Unit(j))).col(j);
    };
    f -= (8 * (stress(1) - stress(-1)) - (stress(2) - stress(-2))) / (12 * h);
  }
  return f;
}

Vec3 point_of(const TetMesh& mesh, int t, const Eigen::Vector4d& b) {
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < 4; ++i) p += b[i] * mesh.nodes[mesh.tet(t)[i]];
  return p;
}

/// L2 error of the displacement.
double field_error(const TetMesh& mesh, const std::vector<Vec3>& displacement) {
  const TetQuadrature& rule = fine_quadrature();
  double sum = 0;
  for (int t = 0; t < mesh.size(); ++t)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Eigen::VectorXd N = tet_shape(mesh.order, rule.points[q]);
      Vec3 u = -exact(point_of(mesh, t, rule.points[q]));
      for (int a = 0; a < tet_nodes(mesh.order); ++a) u += N[a] * displacement[mesh.tet(t)[a]];
      sum += corner_volume(mesh, t) * rule.weights[q] * u.squaredNorm();
    }
  return std::sqrt(sum);
}

}  // namespace

double displacement_error(ElementOrder order, int cells) {
  const TetMesh mesh = in_order(cube(cells), order);
  const std::shared_ptr<const EnergyDensity> law = neo_hookean(lame_moduli(kFleshModulus, 0.3));
  const TetQuadrature& rule = fine_quadrature();
  std::vector<HeldNode> held;
  std::vector<NodalLoad> loads(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    loads[n].node = static_cast<int>(n);
    if (on_cube_surface(mesh.nodes[n])) held.push_back({static_cast<int>(n), Vec3::Zero()});
  }
  for (int t = 0; t < mesh.size(); ++t)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Vec3 f = corner_volume(mesh, t) * rule.weights[q] *
                     body_force(*law, point_of(mesh, t, rule.points[q]));
      const Eigen::VectorXd N = tet_shape(order, rule.points[q]);
      for (int a = 0; a < tet_nodes(order); ++a) loads[mesh.tet(t)[a]].force += N[a] * f;
    }
  return field_error(mesh, solve_equilibrium(mesh, law, held, loads, {1e-12, 60}).displacement);
}

namespace {

/// Orders between neighbouring meshes; the last one is the figure.
double add_orders(ElementOrder order, const std::vector<int>& cells, report::Page::Table& table,
                  plot::LinePlot& plot) {
  const char* label = order == ElementOrder::linear ? "4 nodes" : "10 nodes";
  plot::Series series{label, {}, {}};
  double before = 0, rate = 0;
  for (const int n : cells) {
    const double error = displacement_error(order, n);
    if (before > 0) rate = std::log(before / error) / std::log(n / series.x.back());
    table.rows.push_back({label, fmt::format("{}", n), fmt::format("{:.3e}", error),
                          before > 0 ? fmt::format("{:.2f}", rate) : ""});
    series.x.push_back(n);
    series.y.push_back(std::log10(error));
    before = error;
  }
  plot.series.push_back(series);
  return rate;
}

}  // namespace

Section check_convergence(const VerifyOptions& options) {
  Section s{
      "convergence", "Order of convergence",
      "A sine-shaped displacement is an exact equilibrium under a known body force. Root mean "
      "square error on cubes of n³ cells, neo-Hookean; halving the cells must cut it by 2 to "
      "the power of the order."};
  report::Page::Table table{{"element", "n", "error [mm]", "order"}, {}};
  plot::LinePlot plot{"Error against cells a side", "cells a side", "log10 error [mm]"};
  plot.include_zero = false;
  // The last pair is the figure in both modes.
  const std::vector<int> p1 = options.quick ? std::vector{12, 16} : std::vector{4, 8, 16, 24};
  const std::vector<int> p2 = options.quick ? std::vector{4, 6} : std::vector{2, 4, 8};
  s.figures = {at_least("order of convergence, 4-node elements",
                        add_orders(ElementOrder::linear, p1, table, plot), 1.9),
               at_least("order of convergence, 10-node elements",
                        add_orders(ElementOrder::quadratic, p2, table, plot), 2.8)};
  s.tables = {table};
  s.plots = {plot};
  return s;
}

}  // namespace palpate::verify
