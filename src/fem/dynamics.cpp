// SPDX-License-Identifier: GPL-3.0-or-later
// With h the step, b = 1/4 and g = 1/2, the state at its end is a function of u alone:
//   a = (u - u0) / (b h^2) - v0 / (b h) - (1/(2 b) - 1) a0,   v = v0 + h ((1 - g) a0 + g a)
// and the residual r(u) = M a + (alpha M + beta K) v + f_int - f_ext has, with K in the damping
// frozen, the Jacobian  M (1/(b h^2) + alpha g/(b h)) + K (1 + beta g/(b h)).
#include "fem/dynamics.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::fem {
namespace {

constexpr double kNewmarkBeta = 0.25, kNewmarkGamma = 0.5;

/// Symmetric matrix given by its lower triangle times a vector.
Eigen::VectorXd multiply(const SparsePattern& p, std::span<const double> values,
                         const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int c = 0; c < p.size; ++c) {
    const int first = p.column_start[c];
    y[c] += values[first] * x[c];
    for (int i = first + 1; i < p.column_start[c + 1]; ++i) {
      y[p.row[i]] += values[i] * x[c];
      y[c] += values[i] * x[p.row[i]];
    }
  }
  return y;
}

class Stepper {
 public:
  Stepper(const Body& body, std::span<const double> mass, const Eigen::VectorXd& force,
          Cholesky& cholesky, const DynamicsOptions& options)
      : body_(body), mass_(mass), force_(force), cholesky_(cholesky), options_(options) {
    u_ = v_ = a_ = Eigen::VectorXd::Zero(force.size());
    stiffness_.resize(cholesky.pattern().row.size());
  }

  /// One time step; false where the motion has blown up.
  bool step() {
    const double h = options_.time_step, bh2 = kNewmarkBeta * h * h;
    const Eigen::VectorXd u0 = u_, v0 = v_, a0 = a_;
    for (int i = 0; i < options_.newton_steps; ++i) {
      a_ = (u_ - u0) / bh2 - v0 / (kNewmarkBeta * h) - (0.5 / kNewmarkBeta - 1) * a0;
      v_ = v0 + h * ((1 - kNewmarkGamma) * a0 + kNewmarkGamma * a_);
      if (!solve_for_correction()) return false;
      u_ += correction_;
    }
    a_ = (u_ - u0) / bh2 - v0 / (kNewmarkBeta * h) - (0.5 / kNewmarkBeta - 1) * a0;
    v_ = v0 + h * ((1 - kNewmarkGamma) * a0 + kNewmarkGamma * a_);
    move_ = (u_ - u0).lpNorm<Eigen::Infinity>();
    return std::isfinite(move_) && std::isfinite(body_.energy(u_));
  }

  double move() const { return move_; }
  int indefinite_steps() const { return indefinite_; }
  const Eigen::VectorXd& state() const { return u_; }
  double static_residual() const {
    Eigen::VectorXd g = -force_;
    body_.add_derivatives(u_, HessianKind::exact, &g, nullptr);
    return g.lpNorm<Eigen::Infinity>();
  }

 private:
  bool factorize(HessianKind kind) {
    const double h = options_.time_step, rate = kNewmarkGamma / (kNewmarkBeta * h);
    const double of_mass = 1 / (kNewmarkBeta * h * h) + options_.mass_damping * rate;
    const double of_stiffness = 1 + options_.stiffness_damping * rate;
    std::fill(stiffness_.begin(), stiffness_.end(), 0.0);
    body_.add_derivatives(u_, kind, nullptr, &stiffness_);
    matrix_.resize(stiffness_.size());
    for (std::size_t i = 0; i < matrix_.size(); ++i)
      matrix_[i] = of_mass * mass_[i] + of_stiffness * stiffness_[i];
    return cholesky_.factorize(matrix_);
  }

  bool solve_for_correction() {
    if (!factorize(HessianKind::exact)) {
      ++indefinite_;
      if (!factorize(HessianKind::projected)) return false;
    }
    const SparsePattern& p = cholesky_.pattern();
    Eigen::VectorXd r = multiply(p, mass_, a_ + options_.mass_damping * v_) - force_;
    r += options_.stiffness_damping * multiply(p, stiffness_, v_);
    body_.add_derivatives(u_, HessianKind::exact, &r, nullptr);
    correction_ = -cholesky_.solve(r);
    return correction_.allFinite();
  }

  const Body& body_;
  std::span<const double> mass_;
  const Eigen::VectorXd& force_;
  Cholesky& cholesky_;
  const DynamicsOptions& options_;
  Eigen::VectorXd u_, v_, a_, correction_;  // [mm], [mm/s], [mm/s^2], [mm]
  std::vector<double> stiffness_, matrix_;
  double move_ = 0;
  int indefinite_ = 0;
};

}  // namespace

std::vector<double> consistent_mass(const Topology& topology, const std::vector<Vec3>& nodes,
                                    std::span<const double> density) {
  const TetQuadrature& rule = fine_quadrature();
  const int stride = tet_nodes(topology.order);
  std::vector<double> mass(topology.pattern.row.size(), 0.0);
  for (std::size_t t = 0; t * stride < topology.tets.size(); ++t) {
    const std::int32_t* n = &topology.tets[t * stride];
    Eigen::Matrix<double, 10, 10> element = Eigen::Matrix<double, 10, 10>::Zero();
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Eigen::VectorXd shape = tet_shape(topology.order, rule.points[q]);
      const auto slope = tet_shape_gradient(topology.order, rule.points[q]);
      Mat3 jacobian = Mat3::Zero();
      for (int a = 0; a < stride; ++a) jacobian += nodes[n[a]] * slope.row(a);
      const double weight = density[t] * rule.weights[q] * jacobian.determinant() / 6;
      element.topLeftCorner(stride, stride) += weight * shape * shape.transpose();
    }
    for (int a = 0; a < stride; ++a)
      for (int b = 0; b <= a; ++b) {
        const int fa = topology.free_node[n[a]], fb = topology.free_node[n[b]];
        if (fa >= 0 && fb >= 0) topology.add_block(mass, fa, fb, element(a, b) * Mat3::Identity());
      }
  }
  return mass;
}

RestState step_to_rest(const Body& body, std::span<const double> mass, const Eigen::VectorXd& force,
                       Cholesky& cholesky, const DynamicsOptions& options) {
  Stepper stepper(body, mass, force, cholesky, options);
  RestState out;
  int quiet = 0;
  while (out.steps < options.max_steps && quiet < 2) {
    out.x = stepper.state();
    ++out.steps;
    if (!stepper.step()) break;
    out.x = stepper.state();
    quiet = stepper.move() < options.rest_move ? quiet + 1 : 0;
  }
  out.at_rest = quiet >= 2;
  out.indefinite_steps = stepper.indefinite_steps();
  out.residual = stepper.static_residual();
  return out;
}

}  // namespace palpate::fem
