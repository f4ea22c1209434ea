// SPDX-License-Identifier: GPL-3.0-or-later
// Order of convergence against a manufactured solution: u = a sin(pi x) sin(pi y) sin(pi z) (1, 2,
// -1) on the unit cube, zero on its surface, with the body force that makes it an equilibrium of
// the neo-Hookean law. -f = div P(F(x)), by differences of the exact stress.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fem/equilibrium.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

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

/// Minus the divergence of the exact stress.
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

/// L2 error of the displacement.
double error_of(ElementOrder order, int cells) {
  const TetMesh mesh = scenes::in_order(scenes::cube(cells), order);
  const std::shared_ptr<const EnergyDensity> law = neo_hookean(lame_moduli(0.045658, 0.3));
  const TetQuadrature& rule = fine_quadrature();
  const int stride = tet_nodes(order);
  std::vector<HeldNode> held;
  std::vector<NodalLoad> loads(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    loads[n].node = static_cast<int>(n);
    if (scenes::on_cube_surface(mesh.nodes[n])) held.push_back({static_cast<int>(n), Vec3::Zero()});
  }
  const auto at = [&](int t, const Eigen::Vector4d& b) {
    Vec3 p = Vec3::Zero();
    for (int i = 0; i < 4; ++i) p += b[i] * mesh.nodes[mesh.tet(t)[i]];
    return p;
  };
  for (int t = 0; t < mesh.size(); ++t)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Vec3 f =
          corner_volume(mesh, t) * rule.weights[q] * body_force(*law, at(t, rule.points[q]));
      const Eigen::VectorXd N = tet_shape(order, rule.points[q]);
      for (int a = 0; a < stride; ++a) loads[mesh.tet(t)[a]].force += N[a] * f;
    }
  const Equilibrium e = solve_equilibrium(mesh, law, held, loads, {1e-12, 60});
  double sum = 0;
  for (int t = 0; t < mesh.size(); ++t)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Eigen::VectorXd N = tet_shape(order, rule.points[q]);
      Vec3 u = -exact(at(t, rule.points[q]));
      for (int a = 0; a < stride; ++a) u += N[a] * e.displacement[mesh.tet(t)[a]];
      sum += corner_volume(mesh, t) * rule.weights[q] * u.squaredNorm();
    }
  return std::sqrt(sum);
}

TEST(Convergence, LinearElementsAreOfSecondOrder) {
  const double order =
      std::log2(error_of(ElementOrder::linear, 8) / error_of(ElementOrder::linear, 16));
  std::printf("order %.3f\n", order);
  EXPECT_GE(order, 1.9);
}

TEST(Convergence, QuadraticElementsAreOfThirdOrder) {
  const double order =
      std::log2(error_of(ElementOrder::quadratic, 4) / error_of(ElementOrder::quadratic, 8));
  std::printf("order %.3f\n", order);
  EXPECT_GE(order, 2.8);
}

}  // namespace
}  // namespace palpate::fem
