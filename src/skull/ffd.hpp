// SPDX-License-Identifier: GPL-3.0-or-later
// Free-form deformation by a lattice of Bernstein polynomials (the published fit's tool).
#pragma once
#include <array>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::skull {

/// How eq. 4.9 is read when control points carry weights.
enum class FfdForm {
  literal,      ///< sum B w P', as printed: not affine invariant, moves an untouched object
  rational,     ///< sum B w P' / sum B w: affine invariant; weights alone still shift points
  displacement  ///< x + sum B w (P' - P) / sum B w: an untouched object stays where it is
};

/// (l+1) x (m+1) x (n+1) control points over a box; index (i * (m+1) + j) * (n+1) + k.
struct BernsteinLattice {
  std::array<int, 3> cells{8, 12, 8};  ///< l, m, n >= 1
  Box box;
  std::vector<Vec3> rest;      ///< P_ijk = X0 + (i/l S, j/m T, k/n U) (eq. 4.8), [mm]
  std::vector<Vec3> moved;     ///< P'_ijk, [mm]
  std::vector<double> weight;  ///< w_ijk > 0 [-]

  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * (cells[1] + 1) + j) * (cells[2] + 1) + k;
  }
};

/// Control points at rest, all weights one. @throws InputError  box without volume
[[nodiscard]] BernsteinLattice make_lattice(const Box& box, const std::array<int, 3>& cells);

/// C(n, i) (1-s)^(n-i) s^i for i = 0 ... n; sums to one. Stable for n up to 30.
[[nodiscard]] std::vector<double> bernstein(int n, double s);

/// The deformed position of x (eqs. 4.7 and 4.9). Points outside the box are taken at its border
/// and keep their offset from it.
/// @cite Sederberg & Parry 1986, "Free-form deformation of solid geometric models"
[[nodiscard]] Vec3 deform(const BernsteinLattice& lattice, const Vec3& x, FfdForm form);

}  // namespace palpate::skull
