// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "fem/dead_load.hpp"

namespace palpate::fem {
namespace {

void check_node(std::int32_t node, std::size_t nodes, const char* what) {
  if (node < 0 || static_cast<std::size_t>(node) >= nodes)
    throw InputError(fmt::format("{} names node {}, the mesh has {} nodes", what, node, nodes));
}

/// Scales supports and loads up to 1; a step that fails is halved.
NewtonResult approach(const TetMesh& mesh, const TissueLaws& laws, const Topology& topology,
                      const std::vector<Vec3>& prescribed, const Eigen::VectorXd& force,
                      const EquilibriumOptions& options) {
  constexpr double kSmallestStep = 1.0 / 64;  // then the failure is the state's, not the step's
  Cholesky cholesky(topology.pattern);
  NewtonResult result;
  result.x = Eigen::VectorXd::Zero(topology.unknowns());
  int iterations = 0;
  for (double done = 0, step = 1; done < 1;) {
    const double share = std::min(1.0, done + step);
    std::vector<Vec3> moved = prescribed;
    for (Vec3& u : moved) u *= share;
    const ElasticBody body(topology, mesh.nodes, laws, std::move(moved));
    const Eigen::VectorXd start = done > 0 ? Eigen::VectorXd(share / done * result.x) : result.x;
    try {
      result = minimise(DeadLoaded(body, share * force), start, cholesky,
                        {options.force_tolerance, options.max_iterations});
      iterations += result.iterations;
      done = share;
    } catch (const SolveError&) {
      step *= 0.5;
      if (step < kSmallestStep) throw;
    }
  }
  result.iterations = iterations;
  return result;
}

}  // namespace

Equilibrium solve_equilibrium(const TetMesh& mesh, const TissueLaws& laws,
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
  const Eigen::VectorXd force = load_vector(topology, loads);
  const NewtonResult newton = approach(mesh, laws, topology, prescribed, force, options);
  const ElasticBody body(topology, mesh.nodes, laws, prescribed);
  Equilibrium out{{}, body.nodal_forces(newton.x), newton.residual, newton.iterations};
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    out.displacement.push_back(body.displacement(newton.x, static_cast<int>(n)));
    out.reaction[n] = is_held[n] ? Vec3(-out.reaction[n]) : Vec3::Zero();
  }
  return out;
}

}  // namespace palpate::fem
