// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/loads.hpp"

#include <fmt/format.h>

#include <map>

#include "core/error.hpp"
#include "fem/dead_load.hpp"

namespace palpate::fem {

std::vector<NodalLoad> nodal_force(std::int32_t node, const Vec3& direction) {
  return {{node, direction.normalized()}};
}

std::vector<NodalLoad> pressure_patch(const std::vector<std::int32_t>& faces, ElementOrder order,
                                      const std::vector<Vec3>& nodes, const Vec3& centre,
                                      const Vec3& axis, double radius) {
  const FaceQuadrature& rule = contact_quadrature();
  const int stride = face_nodes(order);
  std::map<std::int32_t, double> share;
  double sum = 0;
  for (std::size_t f = 0; f < faces.size(); f += stride)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const Eigen::VectorXd shape = face_shape(order, rule.points[q]);
      const auto slope = face_shape_gradient(order, rule.points[q]);
      Vec3 at = -centre;
      Eigen::Matrix<double, 3, 2> tangent = Eigen::Matrix<double, 3, 2>::Zero();
      for (int i = 0; i < stride; ++i) {
        at += shape[i] * nodes[faces[f + i]];
        tangent += nodes[faces[f + i]] * slope.row(i);
      }
      const double r_squared = (at - at.dot(axis) * axis).squaredNorm() / (radius * radius);
      if (r_squared >= 1) continue;
      const double push =
          rule.weights[q] * tangent.col(0).cross(tangent.col(1)).norm() * (1 - r_squared);
      for (int i = 0; i < stride; ++i) share[faces[f + i]] += shape[i] * push;
      sum += push;
    }
  if (!(sum > 0)) throw InputError("the pressure patch lies on no face of the skin");
  std::vector<NodalLoad> loads;
  for (const auto& [node, push] : share) loads.push_back({node, push / sum * axis});
  return loads;
}

Eigen::VectorXd load_vector(const Topology& topology, std::span<const NodalLoad> loads) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(topology.unknowns());
  const int nodes = static_cast<int>(topology.free_node.size());
  for (const NodalLoad& l : loads) {
    if (l.node < 0 || l.node >= nodes)
      throw InputError(fmt::format("a load names node {}, the mesh has {} nodes", l.node, nodes));
    const int f = topology.free_node[l.node];
    if (f >= 0) force.segment<3>(3 * f) += l.force;
  }
  return force;
}

LoadedStates load_up(const Body& body, const Eigen::VectorXd& unit, std::span<const double> factors,
                     Cholesky& cholesky, const LoadUpOptions& options) {
  LoadedStates out;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.topology().unknowns());
  const double resultant = std::max(unit.lpNorm<1>(), 1e-300);
  for (const double factor : factors) {
    const double from = out.reached;
    for (double done = 0, step = 1; done < 1;) {
      const double share = std::min(1.0, done + step);
      const double load = from + share * (factor - from);
      try {
        NewtonResult r =
            minimise(DeadLoaded(body, load * unit), x, cholesky,
                     {options.relative_tolerance * load * resultant, options.max_iterations});
        x = std::move(r.x);
        out.iterations += r.iterations;
        out.projections += r.projections;
        out.reached = load;
        done = share;
      } catch (const SolveError& e) {
        out.iterations += e.iterations;
        step *= 0.5;
        if (step >= options.smallest_step) continue;
        out.failure = fmt::format("at {:.3g} N: {}", load, e.what());
        return out;
      }
    }
    out.states.push_back(x);
  }
  return out;
}

}  // namespace palpate::fem
