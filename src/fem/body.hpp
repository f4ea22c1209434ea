// SPDX-License-Identifier: GPL-3.0-or-later
// What every meshed body offers to the solvers: energy, forces and stiffness by its free nodes.
#pragma once
#include "fem/energy.hpp"
#include "fem/topology.hpp"

namespace palpate::fem {

/// How the Hessian is formed: as it is, or with the indefinite part of each element taken out.
enum class HessianKind { exact, projected };

/// A body made of tetrahedra or of their edges. Immutable; safe to use from many threads.
class Body {
 public:
  /// @param topology    shared between bodies of equal connectivity; must outlive the body
  /// @param prescribed  displacement of the held nodes [mm], one per node; empty: zero
  Body(const Topology& topology, std::vector<Vec3> prescribed)
      : topology_(topology), prescribed_(std::move(prescribed)) {}
  virtual ~Body() = default;
  Body(const Body&) = default;
  Body& operator=(const Body&) = delete;

  [[nodiscard]] const Topology& topology() const { return topology_; }
  /// Displacement of node n [mm] under the unknowns x.
  [[nodiscard]] Vec3 displacement(const Eigen::VectorXd& x, int node) const {
    const int f = topology_.free_node[node];
    if (f >= 0) return x.segment<3>(3 * f);
    return prescribed_.empty() ? Vec3::Zero() : prescribed_[node];
  }

  /// Strain energy [N mm]; kInadmissible where an element is inverted and its law forbids it.
  [[nodiscard]] virtual double energy(const Eigen::VectorXd& x) const = 0;
  /// Adds gradient [N] and Hessian [N/mm]; either pointer may be null. x must be admissible.
  virtual void add_derivatives(const Eigen::VectorXd& x, HessianKind kind,
                               Eigen::VectorXd* gradient, std::vector<double>* hessian) const = 0;
  /// Force [N] of the body on each node (free and held): minus the gradient of the energy.
  [[nodiscard]] virtual std::vector<Vec3> nodal_forces(const Eigen::VectorXd& x) const = 0;

 private:
  const Topology& topology_;
  std::vector<Vec3> prescribed_;
};

}  // namespace palpate::fem
