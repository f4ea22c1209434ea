// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes and figures that several sections share.
#pragma once
#include <string>

#include "fem/elastic_body.hpp"

namespace palpate::verify {

inline constexpr double kFleshModulus = 0.045658;  ///< [MPa] thesis, Table 4.2
inline constexpr double kFleshPoisson = 0.43;
[[nodiscard]] fem::LameModuli flesh_moduli();

/// Unit cube, n cells a side, six tetrahedra a cell, linear.
[[nodiscard]] fem::TetMesh cube(int cells);
/// Moves the inner nodes at random by up to `share` of a cell.
void shake(fem::TetMesh& mesh, double share, std::uint64_t seed);
[[nodiscard]] bool on_cube_surface(const Vec3& p);
[[nodiscard]] fem::TetMesh in_order(const fem::TetMesh& linear, fem::ElementOrder order);

/// Symmetric matrix, given by its lower triangle, times a vector.
[[nodiscard]] Eigen::VectorXd times(const fem::SparsePattern& pattern,
                                    const std::vector<double>& values, const Eigen::VectorXd& x);

/// CPU seconds so far, of this process and of those that it started and waited for.
struct CpuSeconds {
  double ours = 0, children = 0;
  [[nodiscard]] static CpuSeconds now();
  /// "GetFEM 4.1 CPU s, ours 0.3", from what was spent since `this`.
  [[nodiscard]] std::string since(const std::string& other) const;
};

}  // namespace palpate::verify
