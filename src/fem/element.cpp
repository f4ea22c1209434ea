// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/element.hpp"

namespace palpate::fem {
namespace {

constexpr std::array<std::array<int, 2>, 3> kFaceEdges = {{{0, 1}, {1, 2}, {2, 0}}};

TetQuadrature four_points() {
  const double a = 0.58541019662496845, b = 0.13819660112501052;  // (5 +- 3 sqrt 5, sqrt 5) / 20
  TetQuadrature q;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d p = Eigen::Vector4d::Constant(b);
    p[i] = a;
    q.points.push_back(p);
    q.weights.push_back(0.25);
  }
  return q;
}

/// Gauss points of a cube, collapsed to the tetrahedron.
TetQuadrature conical_product() {
  constexpr std::array<double, 4> x = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                       0.8611363115940526};
  constexpr std::array<double, 4> w = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                       0.3478548451374538};
  TetQuadrature q;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) {
        const double a = 0.5 * (1 + x[i]), b = 0.5 * (1 + x[j]), c = 0.5 * (1 + x[k]);
        q.points.push_back(
            {a, b * (1 - a), c * (1 - a) * (1 - b), 1 - a - b * (1 - a) - c * (1 - a) * (1 - b)});
        q.weights.push_back(6 * w[i] * w[j] * w[k] / 8 * (1 - a) * (1 - a) * (1 - b));
      }
  return q;
}

FaceQuadrature twelve_points() {
  FaceQuadrature q;
  const auto add = [&q](double a, double b, double c, double w) {
    q.points.push_back({a, b, c});
    q.weights.push_back(w);
  };
  for (const auto& [corner, w] : {std::pair{0.873821971016996, 0.050844906370207},
                                  std::pair{0.501426509658179, 0.116786275726379}}) {
    const double rest = 0.5 * (1 - corner);
    add(corner, rest, rest, w);
    add(rest, corner, rest, w);
    add(rest, rest, corner, w);
  }
  const double a = 0.636502499121399, b = 0.310352451033785, c = 1 - a - b, w = 0.082851075618374;
  add(a, b, c, w), add(b, c, a, w), add(c, a, b, w);
  add(b, a, c, w), add(a, c, b, w), add(c, b, a, w);
  return q;
}

}  // namespace

const TetQuadrature& stiffness_quadrature(ElementOrder order) {
  static const TetQuadrature one{{Eigen::Vector4d::Constant(0.25)}, {1.0}};
  static const TetQuadrature four = four_points();
  return order == ElementOrder::linear ? one : four;
}

const TetQuadrature& fine_quadrature() {
  static const TetQuadrature rule = conical_product();
  return rule;
}

const FaceQuadrature& contact_quadrature() {
  static const FaceQuadrature rule = twelve_points();
  return rule;
}

Eigen::VectorXd tet_shape(ElementOrder order, const Eigen::Vector4d& b) {
  if (order == ElementOrder::linear) return b;
  Eigen::VectorXd n(10);
  for (int i = 0; i < 4; ++i) n[i] = b[i] * (2 * b[i] - 1);
  for (int e = 0; e < 6; ++e) n[4 + e] = 4 * b[kTetEdges[e][0]] * b[kTetEdges[e][1]];
  return n;
}

Eigen::Matrix<double, Eigen::Dynamic, 3> tet_shape_gradient(ElementOrder order,
                                                            const Eigen::Vector4d& b) {
  Eigen::Matrix<double, 4, 3> db;  // barycentric coordinates by (b1, b2, b3)
  db << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  if (order == ElementOrder::linear) return db;
  Eigen::Matrix<double, Eigen::Dynamic, 3> g(10, 3);
  for (int i = 0; i < 4; ++i) g.row(i) = (4 * b[i] - 1) * db.row(i);
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kTetEdges[e];
    g.row(4 + e) = 4 * (b[i] * db.row(j) + b[j] * db.row(i));
  }
  return g;
}

Eigen::VectorXd face_shape(ElementOrder order, const Vec3& b) {
  if (order == ElementOrder::linear) return b;
  Eigen::VectorXd n(6);
  for (int i = 0; i < 3; ++i) n[i] = b[i] * (2 * b[i] - 1);
  for (int e = 0; e < 3; ++e) n[3 + e] = 4 * b[kFaceEdges[e][0]] * b[kFaceEdges[e][1]];
  return n;
}

Eigen::Matrix<double, Eigen::Dynamic, 2> face_shape_gradient(ElementOrder order, const Vec3& b) {
  Eigen::Matrix<double, 3, 2> db;
  db << -1, -1, 1, 0, 0, 1;
  if (order == ElementOrder::linear) return db;
  Eigen::Matrix<double, Eigen::Dynamic, 2> g(6, 2);
  for (int i = 0; i < 3; ++i) g.row(i) = (4 * b[i] - 1) * db.row(i);
  for (int e = 0; e < 3; ++e) {
    const auto [i, j] = kFaceEdges[e];
    g.row(3 + e) = 4 * (b[i] * db.row(j) + b[j] * db.row(i));
  }
  return g;
}

}  // namespace palpate::fem
