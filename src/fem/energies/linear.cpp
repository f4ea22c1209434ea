// SPDX-License-Identifier: GPL-3.0-or-later
// Hooke's law on the small strain eps = sym(F - I): P = 2 mu eps + lambda tr(eps) I, constant
// tangent.
#include "fem/energy.hpp"

namespace palpate::fem {
namespace {

Mat3 small_strain(const Mat3& F) {
  return 0.5 * (F + F.transpose()) - Mat3::Identity();
}

class LinearElastic final : public EnergyDensity {
 public:
  explicit LinearElastic(const LameModuli& m) : lambda_(m.lambda), mu_(m.mu) {}

  double value(const Mat3& F) const override {
    const Mat3 e = small_strain(F);
    return mu_ * e.squaredNorm() + 0.5 * lambda_ * e.trace() * e.trace();
  }

  Mat3 stress(const Mat3& F) const override {
    const Mat3 e = small_strain(F);
    return 2 * mu_ * e + lambda_ * e.trace() * Mat3::Identity();
  }

  Mat9 tangent(const Mat3&) const override {
    const Vec9 identity = vec(Mat3::Identity());
    Mat9 A = lambda_ * identity * identity.transpose();
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        A(i + 3 * j, i + 3 * j) += mu_;
        A(i + 3 * j, j + 3 * i) += mu_;
      }
    return A;
  }

 private:
  double lambda_, mu_;
};

}  // namespace

std::unique_ptr<EnergyDensity> linear_elastic(const LameModuli& moduli) {
  return std::make_unique<LinearElastic>(moduli);
}

}  // namespace palpate::fem
