// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/press.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

class Pressed final : public Potential {
 public:
  Pressed(const Body& body, const Contact& contact, double force)
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
  const Body& body_;
  const Contact& contact_;
  double force_;
  int travel_;
};

/// The same with the travel held at its value: its row and column are those of the unit matrix.
class Driven final : public Potential {
 public:
  Driven(const Body& body, const Contact& contact) : free_(body, contact, 0.0), body_(body) {}
  double value(const Eigen::VectorXd& x) const override { return free_.value(x); }
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const override {
    Eigen::VectorXd g = free_.gradient(x);
    g[body_.topology().travel()] = 0;
    return g;
  }
  void hessian(const Eigen::VectorXd& x, HessianKind kind,
               std::vector<double>& values) const override {
    free_.hessian(x, kind, values);
    const SparsePattern& p = body_.topology().pattern;
    for (int c = 0; c < p.size; ++c) {
      const int last = p.column_start[c + 1] - 1;
      if (p.row[last] == body_.topology().travel()) values[last] = 0;
    }
    values.back() = 1;
  }
  /// [N] push of the indenter.
  double force(const Eigen::VectorXd& x) const {
    return free_.gradient(x)[body_.topology().travel()];
  }

 private:
  Pressed free_;
  const Body& body_;
};

/// Brings x to equilibrium. The force that the tolerance is a share of is known only there: at the
/// start the tool overlaps the tissue and pushes far too hard. @throws SolveError
void settle(const Driven& potential, const PressOptions& options, Cholesky& cholesky,
            Eigen::VectorXd& x, int& iterations) {
  constexpr int kRounds = 10;            // the force falls by orders of magnitude in the first two
  constexpr double kLeastForce = 1e-12;  // [N] where the tool has lost the tissue
  for (int round = 0; round < kRounds; ++round) {
    const double tolerance = options.relative_tolerance * std::max(potential.force(x), kLeastForce);
    NewtonResult r = minimise(potential, x, cholesky, {tolerance, options.max_iterations});
    x = std::move(r.x);
    iterations += r.iterations;
    if (r.residual <= options.relative_tolerance * std::max(potential.force(x), kLeastForce))
      return;
  }
  throw SolveError("the tool's force does not settle");
}

/// Exponent of y ~ x^m around sample i of n.
double local_exponent(std::span<const double> x, std::span<const double> y, std::size_t i,
                      std::size_t n, double alone) {
  const std::size_t before = i > 0 ? i - 1 : 0, after = i + 1 < n ? i + 1 : i;
  if (before == after || !(y[before] > 0)) return alone;
  return std::log(y[after] / y[before]) / std::log(x[after] / x[before]);
}

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
  for (std::size_t i = 0; i < travel.size(); ++i) {
    const double exponent = local_exponent(forces, q, i, travel.size(), kHertzExponent);
    rigid.push_back(travel[i] - 0.5 * exponent * q[i] / (penalty * forces[i]));
  }
  return rigid;
}

PressCurve press(const Body& body, const Contact& contact, std::span<const double> forces,
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
      curve.failure = fmt::format("at {:.3g} N: {}", force, e.what());
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

PressForces press_to(const Body& body, const Contact& contact, std::span<const double> travels,
                     Cholesky& cholesky, const PressOptions& options) {
  PressForces out;
  const Driven potential(body, contact);
  const int travel = body.topology().travel();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.topology().unknowns());
  std::vector<double> q;
  for (const double to : travels) {
    const double before = x[travel];
    if (before > 0 && std::isfinite(potential.value(to / before * x))) x *= to / before;
    x[travel] = to;
    try {
      settle(potential, options, cholesky, x, out.iterations);
    } catch (const SolveError& e) {
      out.iterations += e.iterations;
      out.failure = fmt::format("at {:.3g} mm: {}", to, e.what());
      break;
    }
    out.penalised_force.push_back(potential.force(x));
    q.push_back(contact.squared_pressure(x));
  }
  constexpr double kHertzExponent = 2;  // Q ~ F^(4/3), F ~ d^(3/2)
  for (std::size_t i = 0; i < q.size(); ++i)
    out.force.push_back(out.penalised_force[i] +
                        0.5 * local_exponent(travels, q, i, q.size(), kHertzExponent) * q[i] /
                            (contact.penalty() * travels[i]));
  out.last = std::move(x);
  out.complete = q.size() == travels.size();
  return out;
}

}  // namespace palpate::fem
