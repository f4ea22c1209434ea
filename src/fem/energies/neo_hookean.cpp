// SPDX-License-Identifier: GPL-3.0-or-later
// Compressible neo-Hookean with a logarithmic barrier. With B = F^-T:
//   dJ = J B:dF,  dB = -B dF' B,  so
//   P = mu F + (lambda ln J - mu) B
//   dP = mu dF + (mu - lambda ln J) B dF' B + lambda (B:dF) B.
// Limit cases: F = I gives P = 0 and Hooke's tangent; J -> 0 gives psi -> infinity.
#include <cmath>

#include "fem/energy.hpp"

namespace palpate::fem {
namespace {

class NeoHookean final : public EnergyDensity {
 public:
  explicit NeoHookean(const LameModuli& m) : lambda_(m.lambda), mu_(m.mu) {}

  double value(const Mat3& F) const override {
    const double J = F.determinant();
    if (!(J > 0)) return kInadmissible;
    const double log_j = std::log(J);
    return 0.5 * mu_ * (F.squaredNorm() - 3) - mu_ * log_j + 0.5 * lambda_ * log_j * log_j;
  }

  Mat3 stress(const Mat3& F) const override {
    const Mat3 B = F.inverse().transpose();
    return mu_ * F + (lambda_ * std::log(F.determinant()) - mu_) * B;
  }

  Mat9 tangent(const Mat3& F) const override {
    const Mat3 B = F.inverse().transpose();
    const double swap = mu_ - lambda_ * std::log(F.determinant());
    Mat9 A = lambda_ * vec(B) * vec(B).transpose();
    for (int l = 0; l < 3; ++l)
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
          for (int i = 0; i < 3; ++i) A(i + 3 * j, k + 3 * l) += swap * B(i, l) * B(k, j);
    A.diagonal().array() += mu_;
    return A;
  }

 private:
  double lambda_, mu_;
};

}  // namespace

std::unique_ptr<EnergyDensity> neo_hookean(const LameModuli& moduli) {
  return std::make_unique<NeoHookean>(moduli);
}

}  // namespace palpate::fem
