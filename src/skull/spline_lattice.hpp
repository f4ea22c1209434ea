// SPDX-License-Identifier: GPL-3.0-or-later
// A volume of uniform cubic B-splines: the smooth displacement field of the depth fit.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::skull {

/// The 64 control points that reach one place, and their shares (>= 0, sum 1).
struct SplineWeights {
  std::array<std::int32_t, 64> control;
  std::array<double, 64> share;
};

/// Displacement u(x) = sum over control points of share(x) * control value. Any affine field lies
/// in its span, so its stiffness never fights scale or shear. The box is symmetric about x = 0.
class SplineLattice {
 public:
  /// @param spacing  [mm] > 0 between control points
  /// @throws InputError  box without volume or spacing not positive
  SplineLattice(const Box& box, double spacing);

  [[nodiscard]] int size() const { return count_[0] * count_[1] * count_[2]; }
  /// @param x  [mm] in the box; places outside use the border cell's polynomials
  [[nodiscard]] SplineWeights weights(const Vec3& x) const;
  /// Gradients [1/mm] of the 64 shares, rows as in weights(x).control.
  [[nodiscard]] Eigen::Matrix<double, 64, 3> gradients(const Vec3& x) const;
  /// Index of the control point mirrored at x = 0.
  [[nodiscard]] std::vector<std::int32_t> mirror() const;
  /// K with u^T K u = integral over the box of the squared second derivatives, for one component
  /// of u: |u_xx|^2 + |u_yy|^2 + |u_zz|^2 + 2 (|u_xy|^2 + |u_yz|^2 + |u_xz|^2), [1/mm]. Exact.
  /// Positive semi-definite; its null space is the affine fields.
  [[nodiscard]] Eigen::MatrixXd bending() const;

 private:
  std::array<int, 3> cells_{};
  std::array<int, 3> count_{};  // cells + 3
  Vec3 origin_ = Vec3::Zero();
  double spacing_ = 1;
  struct Place {
    std::array<int, 3> cell;
    Vec3 part;
  };
  [[nodiscard]] Place locate(const Vec3& x) const;
  [[nodiscard]] std::int32_t index(int i, int j, int k) const {
    return (i * count_[1] + j) * count_[2] + k;
  }
};

}  // namespace palpate::skull
