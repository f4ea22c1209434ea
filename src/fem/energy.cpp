// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/energy.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include "core/error.hpp"

namespace palpate::fem {

LameModuli lame_moduli(double e, double nu) {
  if (!(e > 0)) throw InputError(fmt::format("Young's modulus is {} MPa; it must be > 0", e));
  if (!(nu >= 0 && nu < 0.5))
    throw InputError(fmt::format("Poisson's ratio is {}; it must be in [0, 0.5)", nu));
  return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

Mat9 positive_part(const Mat9& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(symmetric);
  if (eigen.eigenvalues()[0] >= 0) return symmetric;
  const Vec9 clamped = eigen.eigenvalues().cwiseMax(0.0);
  return eigen.eigenvectors() * clamped.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace palpate::fem
