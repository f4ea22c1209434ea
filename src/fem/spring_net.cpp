// SPDX-License-Identifier: GPL-3.0-or-later
// With e = x_b - x_a, l = |e|, n = e/l: energy k/2 (l - L)^2, force k (l - L) n, and the Hessian by
// e is k n n' + k (1 - L/l) (I - n n'): the second part is negative in compression.
#include "fem/spring_net.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.hpp"

namespace palpate::fem {

SpringNet::SpringNet(const Topology& topology, const std::vector<Vec3>& nodes,
                     double youngs_modulus, std::vector<Vec3> prescribed)
    : Body(topology, std::move(prescribed)), nodes_(nodes) {
  if (topology.order != ElementOrder::linear) throw InputError("springs need a linear mesh");
  if (!(youngs_modulus > 0))
    throw InputError(fmt::format("Young's modulus is {} MPa; it must be > 0", youngs_modulus));
  std::map<std::array<std::int32_t, 2>, double> volume;
  for (std::size_t t = 0; t < topology.tets.size(); t += 4) {
    const std::int32_t* n = &topology.tets[t];
    const Vec3& o = nodes[n[0]];
    const double v = (nodes[n[1]] - o).cross(nodes[n[2]] - o).dot(nodes[n[3]] - o) / 6;
    for (const auto& [i, j] : kTetEdges) volume[{std::min(n[i], n[j]), std::max(n[i], n[j])}] += v;
  }
  for (const auto& [ends, v] : volume) {
    const double rest = (nodes[ends[1]] - nodes[ends[0]]).norm();
    springs_.push_back({ends[0], ends[1], rest, youngs_modulus * v / (rest * rest)});
  }
}

Vec3 SpringNet::edge(const Eigen::VectorXd& x, const Spring& s) const {
  return nodes_[s.b] + displacement(x, s.b) - nodes_[s.a] - displacement(x, s.a);
}

double SpringNet::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Spring& s : springs_) {
    const double stretch = edge(x, s).norm() - s.rest;
    sum += 0.5 * s.stiffness * stretch * stretch;
  }
  return sum;
}

void SpringNet::add_derivatives(const Eigen::VectorXd& x, HessianKind kind,
                                Eigen::VectorXd* gradient, std::vector<double>* hessian) const {
  for (const Spring& s : springs_) {
    const int a = topology().free_node[s.a], b = topology().free_node[s.b];
    const Vec3 e = edge(x, s);
    const double length = std::max(e.norm(), 1e-9 * s.rest);  // two nodes may meet
    const Vec3 n = e / length;
    if (gradient) {
      const Vec3 force = s.stiffness * (length - s.rest) * n;
      if (a >= 0) gradient->segment<3>(3 * a) -= force;
      if (b >= 0) gradient->segment<3>(3 * b) += force;
    }
    if (!hessian) continue;
    double across = 1 - s.rest / length;
    if (kind == HessianKind::projected) across = std::max(across, 0.0);
    const Mat3 k = s.stiffness * ((1 - across) * n * n.transpose() + across * Mat3::Identity());
    if (a >= 0) topology().add_block(*hessian, a, a, k);
    if (b >= 0) topology().add_block(*hessian, b, b, k);
    if (a >= 0 && b >= 0) topology().add_block(*hessian, a, b, -k);
  }
}

std::vector<Vec3> SpringNet::nodal_forces(const Eigen::VectorXd& x) const {
  std::vector<Vec3> force(nodes_.size(), Vec3::Zero());
  for (const Spring& s : springs_) {
    const Vec3 e = edge(x, s);
    const Vec3 pull = s.stiffness * (1 - s.rest / std::max(e.norm(), 1e-9 * s.rest)) * e;
    force[s.a] += pull;
    force[s.b] -= pull;
  }
  return force;
}

}  // namespace palpate::fem
