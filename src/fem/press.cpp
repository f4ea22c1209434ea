// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/press.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

class Pressed final : public Potential {
 public:
  Pressed(const ElasticBody& body, const Contact& contact, double force)
      : body_(body), contact_(contact), force_(force), travel_(body.topology().travel()) {}
  double value(const Eigen::VectorXd& x) const override {
    const double elastic = body_.energy(x);
    if (elastic == kInadmissible) return kInadmissible;
    return elastic + contact_.energy(x) - force_ * x[travel_];
  }
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const override {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(x.size());
    body_.add_derivatives(x, HessianKind::exact, &g, nullptr);
    contact_.add_derivatives(x, HessianKind::exact, &g, nullptr);
    g[travel_] -= force_;
    return g;
  }
  void hessian(const Eigen::VectorXd& x, HessianKind kind,
               std::vector<double>& values) const override {
    std::fill(values.begin(), values.end(), 0.0);
    body_.add_derivatives(x, kind, nullptr, &values);
    contact_.add_derivatives(x, kind, nullptr, &values);
  }

 private:
  const ElasticBody& body_;
  const Contact& contact_;
  double force_;
  int travel_;
};

/// Polynomial through the last states (at most three) at their forces, evaluated at `force`.
Eigen::VectorXd extrapolate(const std::vector<Eigen::VectorXd>& states,
                            std::span<const double> forces, double force, std::size_t use) {
  const std::size_t first = states.size() - use;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(states.back().size());
  for (std::size_t i = first; i < states.size(); ++i) {
    double weight = 1;
    for (std::size_t j = first; j < states.size(); ++j)
      if (j != i) weight *= (force - forces[j]) / (forces[i] - forces[j]);
    x += weight * states[i];
  }
  return x;
}

/// The extrapolation of highest order that is admissible.
Eigen::VectorXd predict(const Pressed& potential, const std::vector<Eigen::VectorXd>& states,
                        std::span<const double> forces) {
  const double force = forces[states.size()];
  for (std::size_t use = std::min<std::size_t>(3, states.size()); use > 1; --use) {
    Eigen::VectorXd x = extrapolate(states, forces, force, use);
    if (std::isfinite(potential.value(x))) return x;
  }
  return states.back();
}

}  // namespace

std::vector<double> rigid_contact_travel(std::span<const double> forces,
                                         std::span<const double> travel, std::span<const double> q,
                                         double penalty) {
  constexpr double kHertzExponent = 4.0 / 3;
  std::vector<double> rigid;
  const std::size_t n = travel.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i > 0 ? i - 1 : 0, after = i + 1 < n ? i + 1 : i;
    double exponent = kHertzExponent;
    if (before != after && q[before] > 0)
      exponent = std::log(q[after] / q[before]) / std::log(forces[after] / forces[before]);
    rigid.push_back(travel[i] - 0.5 * exponent * q[i] / (penalty * forces[i]));
  }
  return rigid;
}

PressCurve press(const ElasticBody& body, const Contact& contact, std::span<const double> forces,
                 Cholesky& cholesky, const PressOptions& options) {
  PressCurve curve;
  const int travel = body.topology().travel();
  std::vector<Eigen::VectorXd> states;
  std::vector<double> squared_pressure;
  for (const double force : forces) {
    const Pressed potential(body, contact, force);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(body.topology().unknowns());
    start[travel] = options.first_guess;
    if (!states.empty()) start = predict(potential, states, forces);
    try {
      NewtonResult r = minimise(potential, std::move(start), cholesky,
                                {options.relative_tolerance * force, options.max_iterations});
      curve.iterations += r.iterations;
      curve.projections += r.projections;
      curve.residual = r.residual;
      curve.penalised_travel.push_back(r.x[travel]);
      squared_pressure.push_back(contact.squared_pressure(r.x));
      states.push_back(std::move(r.x));
    } catch (const SolveError& e) {
      curve.residual = e.residual;
      curve.iterations += e.iterations;
      break;
    }
  }
  if (!states.empty()) curve.last = states.back();
  curve.travel =
      rigid_contact_travel(forces, curve.penalised_travel, squared_pressure, contact.penalty());
  curve.complete = states.size() == forces.size();
  curve.states = std::move(states);
  return curve;
}

}  // namespace palpate::fem
