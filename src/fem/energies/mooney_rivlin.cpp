// SPDX-License-Identifier: GPL-3.0-or-later
// W = a (J^-2/3 I1 - 3) + b (J^-4/3 I2 - 3) + U(J) + c/2 (J^-2/3 If - 1)^2.
// Each term is g(J) h(I): P and the tangent follow from the chain rule on (I1, I2, J, If).
// Small strains: mu = 2 (a + b), bulk modulus 2 k (the source prints k; method notes, section 5).
#include <array>
#include <cmath>

#include "fem/energies/invariants.hpp"

namespace palpate::fem {
namespace {

/// J^power * I as a scalar of F.
Invariant scaled(const Invariant& i, const Invariant& j, double power) {
  const double g = std::pow(j.value, power);
  const double g1 = power * g / j.value, g2 = (power - 1) * g1 / j.value;
  Invariant out;
  out.value = g * i.value;
  out.gradient = g * i.gradient + g1 * i.value * j.gradient;
  out.hessian = g * i.hessian + g1 * i.value * j.hessian +
                g2 * i.value * j.gradient * j.gradient.transpose() +
                g1 * (i.gradient * j.gradient.transpose() + j.gradient * i.gradient.transpose());
  return out;
}

class MooneyRivlinLaw final : public EnergyDensity {
 public:
  explicit MooneyRivlinLaw(const MooneyRivlin& p) : p_(p) {}

  double value(const Mat3& F) const override {
    if (!(F.determinant() > 0)) return kInadmissible;
    return evaluate(F).value;
  }
  Mat3 stress(const Mat3& F) const override { return unvec(evaluate(F).gradient); }
  Mat9 tangent(const Mat3& F) const override { return evaluate(F).hessian; }

 private:
  Invariant evaluate(const Mat3& F) const {
    const Invariant j = determinant(F);
    const Invariant i1 = scaled(trace_c(F), j, -2.0 / 3), i2 = scaled(second_c(F), j, -4.0 / 3);
    const auto [u, u1, u2] = volume_term(j.value);
    Invariant out;
    out.value = p_.a * (i1.value - 3) + p_.b * (i2.value - 3) + u;
    out.gradient = p_.a * i1.gradient + p_.b * i2.gradient + u1 * j.gradient;
    out.hessian = p_.a * i1.hessian + p_.b * i2.hessian + u1 * j.hessian +
                  u2 * j.gradient * j.gradient.transpose();
    if (p_.fibre_modulus > 0) add_fibre(scaled(along(F, p_.fibre_axis), j, -2.0 / 3), out);
    return out;
  }

  /// U, U' and U'' at J.
  std::array<double, 3> volume_term(double j) const {
    if (p_.volume == VolumeTerm::quadratic)
      return {p_.k * (j - 1) * (j - 1), 2 * p_.k * (j - 1), 2 * p_.k};
    const double log_j = std::log(j);
    return {p_.k * log_j * log_j, 2 * p_.k * log_j / j, 2 * p_.k * (1 - log_j) / (j * j)};
  }

  void add_fibre(const Invariant& stretch_squared, Invariant& out) const {
    const double c = p_.fibre_modulus, e = stretch_squared.value - 1;
    out.value += 0.5 * c * e * e;
    out.gradient += c * e * stretch_squared.gradient;
    out.hessian += c * e * stretch_squared.hessian +
                   c * stretch_squared.gradient * stretch_squared.gradient.transpose();
  }

  MooneyRivlin p_;
};

}  // namespace

std::unique_ptr<EnergyDensity> mooney_rivlin(const MooneyRivlin& parameters) {
  return std::make_unique<MooneyRivlinLaw>(parameters);
}

MooneyRivlin mooney_rivlin_from(const LameModuli& m) {
  MooneyRivlin p;
  p.a = p.b = m.mu / 4;
  p.k = 0.5 * (m.lambda + 2.0 / 3 * m.mu);
  return p;
}

}  // namespace palpate::fem
