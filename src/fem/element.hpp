// SPDX-License-Identifier: GPL-3.0-or-later
// Shape functions and quadrature of 4- and 10-node tetrahedra and of their faces.
//
// Node order of a tetrahedron: corners 0-3, then the middles of edges 01, 12, 02, 03, 13, 23.
// Node order of a face: corners 0-2, then the middles of edges 01, 12, 20.
#pragma once
#include <array>
#include <vector>

#include "core/types.hpp"

namespace palpate::fem {

/// 1 (P1) or 2 (P2).
enum class ElementOrder { linear = 1, quadratic = 2 };
[[nodiscard]] constexpr int tet_nodes(ElementOrder o) {
  return o == ElementOrder::linear ? 4 : 10;
}
[[nodiscard]] constexpr int face_nodes(ElementOrder o) {
  return o == ElementOrder::linear ? 3 : 6;
}

/// Corners of the edges that carry nodes 4-9.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges = {
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Points in barycentric coordinates (the last one is 1 minus the others); weights sum to 1.
struct TetQuadrature {
  std::vector<Eigen::Vector4d> points;
  std::vector<double> weights;
};
struct FaceQuadrature {
  std::vector<Vec3> points;
  std::vector<double> weights;
};
/// One point for P1, four points (exact to degree 2) for P2: exact for the stiffness of a
/// straight-sided element at rest.
[[nodiscard]] const TetQuadrature& stiffness_quadrature(ElementOrder order);
/// 64 points, exact to degree 5: masses and errors of known fields.
/// @cite Stroud 1971, "Approximate Calculation of Multiple Integrals" (conical product rules)
[[nodiscard]] const TetQuadrature& fine_quadrature();
/// Twelve points, exact to degree 6.
/// @cite Dunavant 1985, "High degree efficient symmetrical Gaussian quadrature rules"
[[nodiscard]] const FaceQuadrature& contact_quadrature();

/// Values of the 4 or 10 shape functions at barycentric coordinates b.
[[nodiscard]] Eigen::VectorXd tet_shape(ElementOrder order, const Eigen::Vector4d& b);
/// Their gradients by (b1, b2, b3) with b0 = 1 - b1 - b2 - b3; n x 3.
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, 3> tet_shape_gradient(ElementOrder order,
                                                                          const Eigen::Vector4d& b);
/// Values of the 3 or 6 shape functions of a face.
[[nodiscard]] Eigen::VectorXd face_shape(ElementOrder order, const Vec3& b);
/// Their gradients by (b1, b2) with b0 = 1 - b1 - b2; n x 2.
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, 2> face_shape_gradient(ElementOrder order,
                                                                           const Vec3& b);

}  // namespace palpate::fem
