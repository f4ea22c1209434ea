// SPDX-License-Identifier: GPL-3.0-or-later
// Hooke's law on Green's strain E = (F'F - I)/2. With S = 2 mu E + lambda tr(E) I:
//   P = F S,  dP = dF S + F (2 mu dE + lambda tr(dE) I),  dE = sym(F' dF).
// In uniaxial strain the stress peaks at a stretch of 1/sqrt(3) and falls to 0 at 0: no barrier.
#include "fem/energy.hpp"

namespace palpate::fem {
namespace {

Mat3 green_strain(const Mat3& F) {
  return 0.5 * (F.transpose() * F - Mat3::Identity());
}

class StVenantKirchhoff final : public EnergyDensity {
 public:
  explicit StVenantKirchhoff(const LameModuli& m) : lambda_(m.lambda), mu_(m.mu) {}

  double value(const Mat3& F) const override {
    const Mat3 e = green_strain(F);
    return mu_ * e.squaredNorm() + 0.5 * lambda_ * e.trace() * e.trace();
  }

  Mat3 stress(const Mat3& F) const override { return F * second_stress(green_strain(F)); }

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
    return A;
  }

 private:
  Mat3 second_stress(const Mat3& e) const {
    return 2 * mu_ * e + lambda_ * e.trace() * Mat3::Identity();
  }
  double lambda_, mu_;
};

}  // namespace

std::unique_ptr<EnergyDensity> st_venant_kirchhoff(const LameModuli& moduli) {
  return std::make_unique<StVenantKirchhoff>(moduli);
}

}  // namespace palpate::fem
