// SPDX-License-Identifier: GPL-3.0-or-later
// Hooke's law on Green's strain E = (F'F - I)/2. With S = 2 mu E + lambda tr(E) I:
//   P = F S,  dP = dF S + F (2 mu dE + lambda tr(dE) I),  dE = sym(F' dF).
// In uniaxial strain the stress peaks at a stretch of 1/sqrt(3) and falls to 0 at 0: no barrier.
// The wall r (1 - J)^3 for J < 1 has P = -3 r (1 - J)^2 dJ/dF; value, stress and tangent are
// continuous at J = 1.
#include <fmt/format.h>
#include <cmath>

#include "core/error.hpp"
#include "fem/energies/invariants.hpp"

namespace palpate::fem {
namespace {

Mat3 green_strain(const Mat3& F) {
  return 0.5 * (F.transpose() * F - Mat3::Identity());
}

class StVenantKirchhoff final : public EnergyDensity {
 public:
  StVenantKirchhoff(const LameModuli& m, double wall) : lambda_(m.lambda), mu_(m.mu), wall_(wall) {}

  double value(const Mat3& F) const override {
    const Mat3 e = green_strain(F);
    const double strain = mu_ * e.squaredNorm() + 0.5 * lambda_ * e.trace() * e.trace();
    return wall_ > 0 ? strain + wall_ * std::pow(lost_volume(F), 3) : strain;
  }

  Mat3 stress(const Mat3& F) const override {
    const Mat3 strain = F * second_stress(green_strain(F));
    const double lost = wall_ > 0 ? lost_volume(F) : 0;
    return lost > 0 ? Mat3(strain - 3 * wall_ * lost * lost * unvec(determinant(F).gradient))
                    : strain;
  }

  Mat9 tangent(const Mat3& F) const override {
    const Mat3 S = second_stress(green_strain(F));
    Mat9 A;
    for (int l = 0; l < 3; ++l)
      for (int k = 0; k < 3; ++k) {
        Mat3 dF = Mat3::Zero();
        dF(k, l) = 1;
        const Mat3 dE = 0.5 * (F.transpose() * dF + dF.transpose() * F);
        A.col(k + 3 * l) = vec(dF * S + F * second_stress(dE));
      }
    if (wall_ > 0) add_wall(F, A);
    return A;
  }

 private:
  Mat3 second_stress(const Mat3& e) const {
    return 2 * mu_ * e + lambda_ * e.trace() * Mat3::Identity();
  }
  static double lost_volume(const Mat3& F) { return std::max(0.0, 1 - F.determinant()); }
  void add_wall(const Mat3& F, Mat9& A) const {
    const double lost = lost_volume(F);
    if (lost <= 0) return;
    const Invariant j = determinant(F);
    A += 6 * wall_ * lost * j.gradient * j.gradient.transpose() -
         3 * wall_ * lost * lost * j.hessian;
  }
  double lambda_, mu_, wall_;
};

}  // namespace

std::unique_ptr<EnergyDensity> st_venant_kirchhoff(const LameModuli& m,
                                                   double compression_resistance) {
  if (!(compression_resistance >= 0))
    throw InputError(
        fmt::format("compression resistance is {}; it must be >= 0", compression_resistance));
  // E / (1 - 2 nu) is three times the bulk modulus; 2592 is VEGA's scale.
  const double bulk = m.lambda + 2 * m.mu / 3;
  return std::make_unique<StVenantKirchhoff>(m, compression_resistance * 3 * bulk / 2592);
}

}  // namespace palpate::fem
