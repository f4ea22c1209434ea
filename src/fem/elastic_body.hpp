// SPDX-License-Identifier: GPL-3.0-or-later
// Strain energy of a meshed body with gradient and Hessian by its free displacements.
#pragma once
#include <memory>

#include "fem/energy.hpp"
#include "fem/topology.hpp"

namespace palpate::fem {

/// How the Hessian is formed: as it is, or with each quadrature point's tangent made positive
/// semidefinite.
enum class HessianKind { exact, projected };

/// Shape gradients of one geometry at the quadrature points; isoparametric.
class ElasticBody {
 public:
  /// @param topology  shared between bodies of equal connectivity; must outlive the body
  /// @param nodes     rest positions [mm]
  /// @param prescribed  displacement of the held nodes [mm]; empty: zero
  /// @throws InputError  names the first tetrahedron with a Jacobian <= 0
  ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes,
              std::shared_ptr<const EnergyDensity> law, std::vector<Vec3> prescribed = {});
  /// @param laws  one for all tetrahedra, or one each
  ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes,
              std::vector<std::shared_ptr<const EnergyDensity>> laws,
              std::vector<Vec3> prescribed = {});

  [[nodiscard]] const Topology& topology() const { return topology_; }
  /// Displacement of node n [mm] under the unknowns x.
  [[nodiscard]] Vec3 displacement(const Eigen::VectorXd& x, int node) const;
  /// Strain energy [N mm]; kInadmissible where an element is inverted and the law forbids it.
  [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
  /// Adds gradient [N] and Hessian [N/mm]; either pointer may be null. x must be admissible.
  void add_derivatives(const Eigen::VectorXd& x, HessianKind kind, Eigen::VectorXd* gradient,
                       std::vector<double>* hessian) const;
  /// Force [N] of the body on each node (free and held): minus the gradient of the energy.
  [[nodiscard]] std::vector<Vec3> nodal_forces(const Eigen::VectorXd& x) const;

 private:
  const EnergyDensity& law(std::size_t point) const {
    return *laws_[laws_.size() == 1 ? 0 : point / points_per_tet_];
  }
  Mat3 deformation_gradient(const Eigen::VectorXd& x, std::size_t point) const;
  void add_element_hessian(int tet, const std::vector<Mat9>& tangents,
                           std::vector<double>& hessian) const;

  const Topology& topology_;
  std::vector<std::shared_ptr<const EnergyDensity>> laws_;
  std::vector<Vec3> prescribed_;
  int points_per_tet_;
  std::vector<double> volume_;    // [mm^3] weight of each quadrature point
  std::vector<double> gradient_;  // [1/mm] per point, node by node, three components
};

}  // namespace palpate::fem
