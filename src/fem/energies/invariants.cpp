// SPDX-License-Identifier: GPL-3.0-or-later
//   dI1 = 2 F:dF
//   dI2 = 2 (I1 F - F C):dF,   d(I1 F - F C) = 2 (F:dF) F + I1 dF - dF C - F (dF'F + F'dF)
//   dJ  = cof(F):dF, columns of cof(F) are cross products of the columns of F
//   dIf = 2 F a0 a0':dF
#include "fem/energies/invariants.hpp"

namespace palpate::fem {
namespace {

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

}  // namespace

Invariant trace_c(const Mat3& F) {
  return {F.squaredNorm(), 2 * vec(F), 2 * Mat9::Identity()};
}

Invariant second_c(const Mat3& F) {
  const Mat3 C = F.transpose() * F;
  const double i1 = C.trace();
  Invariant out;
  out.value = 0.5 * (i1 * i1 - C.squaredNorm());
  out.gradient = 2 * vec(i1 * F - F * C);
  for (int c = 0; c < 9; ++c) {
    Mat3 dF = Mat3::Zero();
    dF.data()[c] = 1;
    const Mat3 dC = dF.transpose() * F + F.transpose() * dF;
    out.hessian.col(c) = 2 * vec(dC.trace() * F + i1 * dF - dF * C - F * dC);
  }
  return out;
}

Invariant determinant(const Mat3& F) {
  Invariant out;
  for (int j = 0; j < 3; ++j) {
    const int k = (j + 1) % 3, l = (j + 2) % 3;
    out.gradient.segment<3>(3 * j) = F.col(k).cross(F.col(l));
    out.hessian.block<3, 3>(3 * j, 3 * k) = -cross_matrix(F.col(l));
    out.hessian.block<3, 3>(3 * j, 3 * l) = cross_matrix(F.col(k));
  }
  out.value = F.col(0).dot(out.gradient.head<3>());
  return out;
}

Invariant along(const Mat3& F, const Vec3& a) {
  Invariant out;
  out.value = (F * a).squaredNorm();
  out.gradient = 2 * vec(F * a * a.transpose());
  for (int j = 0; j < 3; ++j)
    for (int l = 0; l < 3; ++l)
      out.hessian.block<3, 3>(3 * j, 3 * l) = 2 * a[j] * a[l] * Mat3::Identity();
  return out;
}

}  // namespace palpate::fem
