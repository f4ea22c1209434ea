// SPDX-License-Identifier: GPL-3.0-or-later
// Invariants of C = F'F with their derivatives by F: the ground for laws W(I1, I2, J, If).
#pragma once
#include "fem/energy.hpp"

namespace palpate::fem {

/// One scalar of F with gradient and Hessian by vec(F).
struct Invariant {
  double value = 0;
  Vec9 gradient = Vec9::Zero();
  Mat9 hessian = Mat9::Zero();
};
[[nodiscard]] Invariant trace_c(const Mat3& F);                       ///< I1 = tr C
[[nodiscard]] Invariant second_c(const Mat3& F);                      ///< I2 = (I1^2 - tr C^2)/2
[[nodiscard]] Invariant determinant(const Mat3& F);                   ///< J; F may be singular
[[nodiscard]] Invariant along(const Mat3& F, const Vec3& unit_axis);  ///< If = a0 . C a0

}  // namespace palpate::fem
