// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/equilibrium.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

class DeadLoaded final : public Potential {
 public:
  DeadLoaded(const ElasticBody& body, Eigen::VectorXd force)
      : body_(body), force_(std::move(force)) {}
  double value(const Eigen::VectorXd& x) const override { return body_.energy(x) - force_.dot(x); }
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const override {
    Eigen::VectorXd g = -force_;
    body_.add_derivatives(x, HessianKind::exact, &g, nullptr);
    return g;
  }
  void hessian(const Eigen::VectorXd& x, HessianKind kind,
               std::vector<double>& values) const override {
    std::fill(values.begin(), values.end(), 0.0);
    body_.add_derivatives(x, kind, nullptr, &values);
  }

 private:
  const ElasticBody& body_;
  Eigen::VectorXd force_;
};

void check_node(std::int32_t node, std::size_t nodes, const char* what) {
  if (node < 0 || static_cast<std::size_t>(node) >= nodes)
    throw InputError(fmt::format("{} names node {}, the mesh has {} nodes", what, node, nodes));
}

}  // namespace

Equilibrium solve_equilibrium(const TetMesh& mesh, std::shared_ptr<const EnergyDensity> law,
                              std::span<const HeldNode> held, std::span<const NodalLoad> loads,
                              const EquilibriumOptions& options) {
  check_mesh(mesh);
  std::vector<std::uint8_t> is_held(mesh.nodes.size(), 0);
  std::vector<Vec3> prescribed(mesh.nodes.size(), Vec3::Zero());
  for (const HeldNode& h : held) {
    check_node(h.node, mesh.nodes.size(), "a support");
    if (is_held[h.node]) throw InputError(fmt::format("node {} is held twice", h.node));
    is_held[h.node] = 1;
    prescribed[h.node] = h.displacement;
  }
  const Topology topology = make_topology(mesh, is_held);
  const ElasticBody body(topology, mesh.nodes, std::move(law), prescribed);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(topology.unknowns());
  for (const NodalLoad& l : loads) {
    check_node(l.node, mesh.nodes.size(), "a load");
    const int f = topology.free_node[l.node];
    if (f >= 0) force.segment<3>(3 * f) += l.force;
  }
  Cholesky cholesky(topology.pattern);
  const NewtonResult newton =
      minimise(DeadLoaded(body, force), Eigen::VectorXd::Zero(topology.unknowns()), cholesky,
               {options.force_tolerance, options.max_iterations});
  Equilibrium out{{}, body.nodal_forces(newton.x), newton.residual, newton.iterations};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    out.displacement.push_back(body.displacement(newton.x, static_cast<int>(n)));
    out.reaction[n] = is_held[n] ? Vec3(-out.reaction[n]) : Vec3::Zero();
  }
  return out;
}

}  // namespace palpate::fem
