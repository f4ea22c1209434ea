// SPDX-License-Identifier: GPL-3.0-or-later
// Every law's stress against differences of its energy and its tangent against differences of its
// stress. The step is 1e-3 with a fourth-order difference: its error is far below the limit.
#include <fmt/format.h>

#include <cmath>
#include <random>

#include "fem/energy.hpp"
#include "fem/spring_net.hpp"
#include "verify/blocks.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;

struct NamedLaw {
  const char* name;
  std::shared_ptr<const EnergyDensity> law;
};

std::vector<NamedLaw> all_laws() {
  const LameModuli m = flesh_moduli();
  MooneyRivlin fibre = mooney_rivlin_from(m), quadratic = fibre;
  fibre.fibre_modulus = 0.02;
  fibre.fibre_axis = Vec3(1, 2, -0.5).normalized();
  quadratic.volume = VolumeTerm::quadratic;
  return {{"neo-Hookean", neo_hookean(m)},
          {"Mooney-Rivlin, U = k ln² J", mooney_rivlin(mooney_rivlin_from(m))},
          {"Mooney-Rivlin, U = k (J - 1)²", mooney_rivlin(quadratic)},
          {"W = F1 + U + F2 with fibres", mooney_rivlin(fibre)},
          {"Saint-Venant-Kirchhoff", st_venant_kirchhoff(m)},
          {"the same with compression resistance 500", st_venant_kirchhoff(m, 500)},
          {"small-strain linear", linear_elastic(m)},
          {"corotational", corotational(m)}};
}

Mat3 random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> d;
  const double w = d(random), x = d(random), y = d(random), z = d(random);
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

/// Random rotations and stretches with a volume ratio from 0.3 to 3.
Mat3 random_state(std::mt19937_64& random) {
  std::uniform_real_distribution<double> stretch(std::log(0.6), std::log(1.6)),
      volume(std::log(0.3), std::log(3.0));
  const double a = stretch(random), b = stretch(random), c = stretch(random);
  Vec3 s(a, b, c);
  s.array() += (volume(random) - s.sum()) / 3;
  const Mat3 left = random_rotation(random), right = random_rotation(random);
  return left * s.array().exp().matrix().asDiagonal() * right;
}

template <class Function>
auto difference(const Function& f, const Mat3& state, int entry) {
  constexpr double h = 1e-3;
  const auto at = [&](double t) {
    Mat3 moved = state;
    moved.data()[entry] += t * h;
    return f(moved);
  };
  return decltype(f(state))((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h));
}

struct Errors {
  double stress = 0, tangent = 0;  // largest over the states, relative to the tangent's norm
};

Errors errors_of(const EnergyDensity& law, int states) {
  std::mt19937_64 random(7);
  Errors worst;
  for (int i = 0; i < states; ++i) {
    const Mat3 F = random_state(random);
    Mat3 stress;
    Mat9 tangent;
    for (int c = 0; c < 9; ++c) {
      stress.data()[c] = difference([&](const Mat3& x) { return law.value(x); }, F, c);
      tangent.col(c) = difference([&](const Mat3& x) -> Vec9 { return vec(law.stress(x)); }, F, c);
    }
    const double scale = law.tangent(F).norm();
    worst.stress = std::max(worst.stress, (stress - law.stress(F)).norm() / scale);
    worst.tangent = std::max(worst.tangent, (tangent - law.tangent(F)).norm() / scale);
  }
  return worst;
}

/// The net's gradient and Hessian along random directions from random states.
Errors spring_errors(int states) {
  const TetMesh mesh = cube(2);
  const std::vector<std::uint8_t> held(mesh.nodes.size(), 0);
  const Topology t = make_topology(mesh, held);
  const SpringNet net(t, mesh.nodes, kFleshModulus);
  const auto gradient = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(at.size());
    net.add_derivatives(at, HessianKind::exact, &g, nullptr);
    return g;
  };
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> d(-0.1, 0.1);
  constexpr double h = 1e-3;
  Errors worst;
  for (int i = 0; i < states; ++i) {
    Eigen::VectorXd x(t.unknowns()), v(t.unknowns());
    for (double& e : x) e = d(random);
    for (double& e : v) e = d(random);
    std::vector<double> values(t.pattern.row.size(), 0.0);
    net.add_derivatives(x, HessianKind::exact, nullptr, &values);
    const Eigen::VectorXd product = times(t.pattern, values, v);
    const auto energy = [&](double s) { return net.energy(x + s * h * v); };
    const auto slope = [&](double s) { return gradient(x + s * h * v); };
    const double along = (8 * (energy(1) - energy(-1)) - (energy(2) - energy(-2))) / (12 * h);
    const Eigen::VectorXd curve = (8 * (slope(1) - slope(-1)) - (slope(2) - slope(-2))) / (12 * h);
    const double scale = product.norm() * v.norm();
    worst.stress = std::max(worst.stress, std::abs(along - gradient(x).dot(v)) / scale);
    worst.tangent = std::max(worst.tangent, (curve - product).norm() / product.norm());
  }
  return worst;
}

}  // namespace

Section check_derivatives(const VerifyOptions& options) {
  const int states = options.quick ? 20 : 200;
  Section s{"derivatives", "Gradients and Hessians against differences",
            fmt::format("Largest relative error over {} random states per law, volume ratio J from "
                        "0.3 to 3.",
                        states)};
  report::Page::Table table{{"law", "stress", "tangent"}, {}};
  double worst = 0;
  const auto add = [&](const char* law, const Errors& e) {
    table.rows.push_back({law, fmt::format("{:.1e}", e.stress), fmt::format("{:.1e}", e.tangent)});
    worst = std::max({worst, e.stress, e.tangent});
  };
  for (const NamedLaw& l : all_laws()) add(l.name, errors_of(*l.law, states));
  add("mass-spring net", spring_errors(states / 10));
  s.figures = {at_most("gradient and Hessian, every law", worst, 1e-6)};
  s.tables = {table};
  return s;
}

}  // namespace palpate::verify
