// SPDX-License-Identifier: GPL-3.0-or-later
// Fixed corotated elasticity without the determinant term. With F = U diag(s) V' (U, V rotations,
// the last s may be negative) and R = U V':
//   P = 2 mu (F - R) + lambda tr(R'F - I) R
//   dP = 2 mu (dF - dR) + lambda (R:dF) R + lambda tr(S - I) dR.
// dR acts on the three twists T_k = U [e_k]x V' / sqrt(2) alone, with factor 2 / (s_i + s_j)
// (Smith, de Goes & Kim 2019, "Analytic Eigensystems for Isotropic Distortion Energies", section
// 4). Limit: s_i + s_j -> 0 (a half turn between two axes) has no nearest rotation; the factor is
// bounded there.
#include <Eigen/SVD>
#include <cmath>

#include "fem/energy.hpp"

namespace palpate::fem {
namespace {

constexpr double kSmallestStretchSum = 1e-6;  // [-] bounds 2 / (s_i + s_j)

struct SignedSvd {
  Mat3 U, V;
  Vec3 s;
  explicit SignedSvd(const Mat3& F) {
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    U = svd.matrixU();
    V = svd.matrixV();
    s = svd.singularValues();
    const bool flip_u = U.determinant() < 0, flip_v = V.determinant() < 0;
    if (flip_u) U.col(2) *= -1;
    if (flip_v) V.col(2) *= -1;
    if (flip_u != flip_v) s[2] *= -1;
  }
  Mat3 rotation() const { return U * V.transpose(); }
};

class Corotational final : public EnergyDensity {
 public:
  explicit Corotational(const LameModuli& m) : lambda_(m.lambda), mu_(m.mu) {}

  double value(const Mat3& F) const override {
    const Vec3 e = SignedSvd(F).s - Vec3::Ones();
    return mu_ * e.squaredNorm() + 0.5 * lambda_ * e.sum() * e.sum();
  }

  Mat3 stress(const Mat3& F) const override {
    const SignedSvd svd(F);
    const Mat3 R = svd.rotation();
    return 2 * mu_ * (F - R) + lambda_ * (svd.s.sum() - 3) * R;
  }

  Mat9 tangent(const Mat3& F) const override {
    const SignedSvd svd(F);
    const Vec9 R = vec(svd.rotation());
    const double twist = lambda_ * (svd.s.sum() - 3) - 2 * mu_;
    Mat9 A = 2 * mu_ * Mat9::Identity() + lambda_ * R * R.transpose();
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      Mat3 generator = Mat3::Zero();
      generator(i, j) = -std::sqrt(0.5);
      generator(j, i) = std::sqrt(0.5);
      const Vec9 t = vec(svd.U * generator * svd.V.transpose());
      A += twist * 2 / std::max(svd.s[i] + svd.s[j], kSmallestStretchSum) * t * t.transpose();
    }
    return A;
  }

 private:
  double lambda_, mu_;
};

}  // namespace

std::unique_ptr<EnergyDensity> corotational(const LameModuli& moduli) {
  return std::make_unique<Corotational>(moduli);
}

}  // namespace palpate::fem
