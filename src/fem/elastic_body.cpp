// SPDX-License-Identifier: GPL-3.0-or-later
// F(q) = I + sum_a u_a (x) G_a(q);  dE/du_a = sum_q w P G_a;  with the 9 x 9 tangent A,
// d2E/du_a du_b = sum_q w sum_jl G_a[j] A(.j, .l) G_b[l].
#include "fem/elastic_body.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace palpate::fem {

ElasticBody::ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes,
                         std::shared_ptr<const EnergyDensity> law, std::vector<Vec3> prescribed)
    : ElasticBody(topology, nodes,
                  std::vector<std::shared_ptr<const EnergyDensity>>{std::move(law)},
                  std::move(prescribed)) {}

ElasticBody::ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes,
                         std::vector<std::shared_ptr<const EnergyDensity>> laws,
                         std::vector<Vec3> prescribed)
    : topology_(topology), laws_(std::move(laws)), prescribed_(std::move(prescribed)) {
  const TetQuadrature& rule = stiffness_quadrature(topology.order);
  const int stride = tet_nodes(topology.order);
  points_per_tet_ = static_cast<int>(rule.weights.size());
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> reference;
  for (const auto& b : rule.points) reference.push_back(tet_shape_gradient(topology.order, b));
  const int tets = static_cast<int>(topology.tets.size()) / stride;
  volume_.reserve(tets * points_per_tet_);
  gradient_.reserve(tets * points_per_tet_ * stride * 3);
  for (int t = 0; t < tets; ++t)
    for (int q = 0; q < points_per_tet_; ++q) {
      Mat3 jacobian = Mat3::Zero();  // dX/d(b1, b2, b3)
      for (int a = 0; a < stride; ++a)
        jacobian += nodes[topology.tets[t * stride + a]] * reference[q].row(a);
      const double det = jacobian.determinant();
      if (!(det > 0))
        throw InputError(fmt::format("tetrahedron {} is inverted (Jacobian {} mm^3)", t, det));
      volume_.push_back(rule.weights[q] * det / 6);
      const Mat3 inverse = jacobian.inverse();
      for (int a = 0; a < stride; ++a) {
        const Vec3 g = inverse.transpose() * reference[q].row(a).transpose();
        gradient_.insert(gradient_.end(), g.data(), g.data() + 3);
      }
    }
}

Vec3 ElasticBody::displacement(const Eigen::VectorXd& x, int node) const {
  const int f = topology_.free_node[node];
  if (f >= 0) return x.segment<3>(3 * f);
  return prescribed_.empty() ? Vec3::Zero() : prescribed_[node];
}

Mat3 ElasticBody::deformation_gradient(const Eigen::VectorXd& x, std::size_t point) const {
  const int stride = tet_nodes(topology_.order);
  const std::int32_t* node = &topology_.tets[point / points_per_tet_ * stride];
  const double* g = &gradient_[point * stride * 3];
  Mat3 F = Mat3::Identity();
  for (int a = 0; a < stride; ++a, g += 3)
    F.noalias() += displacement(x, node[a]) * Eigen::Map<const Vec3>(g).transpose();
  return F;
}

double ElasticBody::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    const double psi = law(p).value(deformation_gradient(x, p));
    if (psi == kInadmissible) return kInadmissible;
    sum += volume_[p] * psi;
  }
  return sum;
}

void ElasticBody::add_derivatives(const Eigen::VectorXd& x, HessianKind kind,
                                  Eigen::VectorXd* gradient, std::vector<double>* hessian) const {
  const int stride = tet_nodes(topology_.order);
  std::vector<Mat9> tangents(points_per_tet_);
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    const Mat3 F = deformation_gradient(x, p);
    const int tet = static_cast<int>(p / points_per_tet_);
    if (gradient) {
      const Mat3 P = volume_[p] * law(p).stress(F);
      for (int a = 0; a < stride; ++a) {
        const int f = topology_.free_node[topology_.tets[tet * stride + a]];
        const Eigen::Map<const Vec3> g(&gradient_[(p * stride + a) * 3]);
        if (f >= 0) gradient->segment<3>(3 * f) += P * g;
      }
    }
    if (!hessian) continue;
    Mat9& A = tangents[p % points_per_tet_];
    A = law(p).tangent(F);
    if (kind == HessianKind::projected) A = positive_part(A);
    A *= volume_[p];
    if ((p + 1) % points_per_tet_ == 0) add_element_hessian(tet, tangents, *hessian);
  }
}

void ElasticBody::add_element_hessian(int tet, const std::vector<Mat9>& tangents,
                                      std::vector<double>& hessian) const {
  const int stride = tet_nodes(topology_.order);
  for (int b = 0; b < stride; ++b) {
    const int fb = topology_.free_node[topology_.tets[tet * stride + b]];
    if (fb < 0) continue;
    std::array<Mat3, 10> block;
    for (int a = 0; a <= b; ++a) block[a].setZero();
    for (int q = 0; q < points_per_tet_; ++q) {
      const double* g =
          &gradient_[static_cast<std::size_t>(tet * points_per_tet_ + q) * stride * 3];
      Eigen::Matrix<double, 9, 3> AG = g[3 * b] * tangents[q].middleCols<3>(0);
      AG += g[3 * b + 1] * tangents[q].middleCols<3>(3);
      AG += g[3 * b + 2] * tangents[q].middleCols<3>(6);
      for (int a = 0; a <= b; ++a)
        block[a] += g[3 * a] * AG.topRows<3>() + g[3 * a + 1] * AG.middleRows<3>(3) +
                    g[3 * a + 2] * AG.bottomRows<3>();
    }
    for (int a = 0; a <= b; ++a) {
      const int fa = topology_.free_node[topology_.tets[tet * stride + a]];
      if (fa >= 0) topology_.add_block(hessian, fa, fb, block[a]);
    }
  }
}

std::vector<Vec3> ElasticBody::nodal_forces(const Eigen::VectorXd& x) const {
  const int stride = tet_nodes(topology_.order);
  std::vector<Vec3> force(topology_.free_node.size(), Vec3::Zero());
  for (std::size_t p = 0; p < volume_.size(); ++p) {
    const Mat3 P = volume_[p] * law(p).stress(deformation_gradient(x, p));
    for (int a = 0; a < stride; ++a)
      force[topology_.tets[p / points_per_tet_ * stride + a]] -=
          P * Eigen::Map<const Vec3>(&gradient_[(p * stride + a) * 3]);
  }
  return force;
}

}  // namespace palpate::fem
