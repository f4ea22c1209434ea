// SPDX-License-Identifier: GPL-3.0-or-later
// F(q) = I + sum_a u_a (x) G_a(q);  dE/du_a = sum_q w P G_a;  with the 9 x 9 tangent A,
// d2E/du_a du_b = sum_q w sum_jl G_a[j] A(.j, .l) G_b[l].
#include "fem/elastic_body.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

void check_laws(const TissueLaws& laws, int tets) {
  if (!laws.of_tet.empty() && laws.of_tet.size() != static_cast<std::size_t>(tets))
    throw InputError(fmt::format("{} tetrahedra, laws for {}", tets, laws.of_tet.size()));
  for (std::size_t t = 0; t < laws.of_tet.size(); ++t)
    if (laws.of_tet[t] < 0 || laws.of_tet[t] >= std::ssize(laws.laws))
      throw InputError(fmt::format("tetrahedron {} has law {}, there are {}", t, laws.of_tet[t],
                                   laws.laws.size()));
}

}  // namespace

TissueLaws neo_hookean_centred(const LameModuli& m) {
  TissueLaws laws(neo_hookean({0, m.mu}));
  laws.at_centre = neo_hookean({m.lambda, 0});
  return laws;
}

TissueLaws linear_elastic_centred(const LameModuli& m) {
  TissueLaws laws(linear_elastic({0, m.mu}));
  laws.at_centre = linear_elastic({m.lambda, 0});
  return laws;
}

ElasticBody::ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes, TissueLaws laws,
                         std::vector<Vec3> prescribed)
    : Body(topology, std::move(prescribed)), laws_(std::move(laws)) {
  check_laws(laws_, static_cast<int>(topology.tets.size()) / tet_nodes(topology.order));
  add_points(nodes, stiffness_quadrature(topology.order));
  if (laws_.at_centre) add_points(nodes, stiffness_quadrature(ElementOrder::linear));
}

void ElasticBody::add_points(const std::vector<Vec3>& nodes, const TetQuadrature& rule) {
  const int stride = tet_nodes(topology().order);
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> reference;
  for (const auto& b : rule.points) reference.push_back(tet_shape_gradient(topology().order, b));
  Points out{static_cast<int>(rule.weights.size()), {}, {}};
  const int tets = static_cast<int>(topology().tets.size()) / stride;
  out.volume.reserve(tets * out.per_tet);
  out.gradient.reserve(tets * out.per_tet * stride * 3);
  for (int t = 0; t < tets; ++t)
    for (int q = 0; q < out.per_tet; ++q) {
      Mat3 jacobian = Mat3::Zero();  // dX/d(b1, b2, b3)
      for (int a = 0; a < stride; ++a)
        jacobian += nodes[topology().tets[t * stride + a]] * reference[q].row(a);
      const double det = jacobian.determinant();
      if (!(det > 0))
        throw InputError(fmt::format("tetrahedron {} is inverted (Jacobian {} mm^3)", t, det));
      out.volume.push_back(rule.weights[q] * det / 6);
      const Mat3 inverse = jacobian.inverse();
      for (int a = 0; a < stride; ++a) {
        const Vec3 g = inverse.transpose() * reference[q].row(a).transpose();
        out.gradient.insert(out.gradient.end(), g.data(), g.data() + 3);
      }
    }
  rules_.push_back(std::move(out));
}

Mat3 ElasticBody::deformation_gradient(const Eigen::VectorXd& x, const Points& points,
                                       std::size_t point) const {
  const int stride = tet_nodes(topology().order);
  const std::int32_t* node = &topology().tets[point / points.per_tet * stride];
  const double* g = &points.gradient[point * stride * 3];
  Mat3 F = Mat3::Identity();
  for (int a = 0; a < stride; ++a, g += 3)
    F.noalias() += displacement(x, node[a]) * Eigen::Map<const Vec3>(g).transpose();
  return F;
}

double ElasticBody::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (std::size_t r = 0; r < rules_.size(); ++r)
    for (std::size_t p = 0; p < rules_[r].volume.size(); ++p) {
      const double psi = law(r, p / rules_[r].per_tet).value(deformation_gradient(x, rules_[r], p));
      if (psi == kInadmissible) return kInadmissible;
      sum += rules_[r].volume[p] * psi;
    }
  return sum;
}

void ElasticBody::add_derivatives(const Eigen::VectorXd& x, HessianKind kind,
                                  Eigen::VectorXd* gradient, std::vector<double>* hessian) const {
  const int stride = tet_nodes(topology().order);
  for (std::size_t r = 0; r < rules_.size(); ++r) {
    const Points& points = rules_[r];
    std::vector<Mat9> tangents(points.per_tet);
    for (std::size_t p = 0; p < points.volume.size(); ++p) {
      const Mat3 F = deformation_gradient(x, points, p);
      const int tet = static_cast<int>(p / points.per_tet);
      if (gradient) {
        const Mat3 P = points.volume[p] * law(r, tet).stress(F);
        for (int a = 0; a < stride; ++a) {
          const int f = topology().free_node[topology().tets[tet * stride + a]];
          const Eigen::Map<const Vec3> g(&points.gradient[(p * stride + a) * 3]);
          if (f >= 0) gradient->segment<3>(3 * f) += P * g;
        }
      }
      if (!hessian) continue;
      Mat9& A = tangents[p % points.per_tet];
      A = law(r, tet).tangent(F);
      if (kind == HessianKind::projected) A = positive_part(A);
      A *= points.volume[p];
      if ((p + 1) % points.per_tet == 0) add_element_hessian(points, tet, tangents, *hessian);
    }
  }
}

void ElasticBody::add_element_hessian(const Points& points, int tet,
                                      const std::vector<Mat9>& tangents,
                                      std::vector<double>& hessian) const {
  const int stride = tet_nodes(topology().order);
  for (int b = 0; b < stride; ++b) {
    const int fb = topology().free_node[topology().tets[tet * stride + b]];
    if (fb < 0) continue;
    std::array<Mat3, 10> block;
    for (int a = 0; a <= b; ++a) block[a].setZero();
    for (int q = 0; q < points.per_tet; ++q) {
      const double* g =
          &points.gradient[static_cast<std::size_t>(tet * points.per_tet + q) * stride * 3];
      Eigen::Matrix<double, 9, 3> AG = g[3 * b] * tangents[q].middleCols<3>(0);
      AG += g[3 * b + 1] * tangents[q].middleCols<3>(3);
      AG += g[3 * b + 2] * tangents[q].middleCols<3>(6);
      for (int a = 0; a <= b; ++a)
        block[a] += g[3 * a] * AG.topRows<3>() + g[3 * a + 1] * AG.middleRows<3>(3) +
                    g[3 * a + 2] * AG.bottomRows<3>();
    }
    for (int a = 0; a <= b; ++a) {
      const int fa = topology().free_node[topology().tets[tet * stride + a]];
      if (fa >= 0) topology().add_block(hessian, fa, fb, block[a]);
    }
  }
}

std::vector<Vec3> ElasticBody::nodal_forces(const Eigen::VectorXd& x) const {
  const int stride = tet_nodes(topology().order);
  std::vector<Vec3> force(topology().free_node.size(), Vec3::Zero());
  for (std::size_t r = 0; r < rules_.size(); ++r)
    for (std::size_t p = 0; p < rules_[r].volume.size(); ++p) {
      const std::size_t tet = p / rules_[r].per_tet;
      const Mat3 P =
          rules_[r].volume[p] * law(r, tet).stress(deformation_gradient(x, rules_[r], p));
      for (int a = 0; a < stride; ++a)
        force[topology().tets[tet * stride + a]] -=
            P * Eigen::Map<const Vec3>(&rules_[r].gradient[(p * stride + a) * 3]);
    }
  return force;
}

int ElasticBody::inverted_tets(const Eigen::VectorXd& x) const {
  const Points& points = rules_.front();
  int count = 0;
  for (std::size_t first = 0; first < points.volume.size(); first += points.per_tet) {
    bool inverted = false;
    for (int q = 0; q < points.per_tet && !inverted; ++q)
      inverted = !(deformation_gradient(x, points, first + q).determinant() > 0);
    count += inverted;
  }
  return count;
}

}  // namespace palpate::fem
