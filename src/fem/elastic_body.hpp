// SPDX-License-Identifier: GPL-3.0-or-later
// Strain energy of a meshed body with gradient and Hessian by its free displacements.
#pragma once
#include <concepts>
#include <memory>

#include "fem/body.hpp"

namespace palpate::fem {

/// The law of each tetrahedron: one for all, or one per kind of tissue.
struct TissueLaws {
  std::vector<std::shared_ptr<const EnergyDensity>> laws;
  std::vector<std::int32_t> of_tet;  ///< index into `laws`, one per tet; empty: laws[0] everywhere
  /// A share of the energy that is integrated with one point, at the centre of each tet; null:
  /// none. With the volume's share here a quadratic tet does not lock when Poisson's ratio nears
  /// 1/2: four points hold the volume at four places, more than its nodes can give.
  /// @cite Malkus & Hughes 1978, "Mixed finite element methods - reduced and selective integration
  /// techniques: a unification of concepts"
  std::shared_ptr<const EnergyDensity> at_centre;

  template <class Law>
  requires std::convertible_to<Law, std::shared_ptr<const EnergyDensity>> TissueLaws(Law one)
      : laws{std::shared_ptr<const EnergyDensity>(std::move(one))} {}
  TissueLaws(std::vector<std::shared_ptr<const EnergyDensity>> kinds,
             std::vector<std::int32_t> kind_of_tet)
      : laws(std::move(kinds)), of_tet(std::move(kind_of_tet)) {}
  [[nodiscard]] const EnergyDensity& at(std::size_t tet) const {
    return *laws[of_tet.empty() ? 0 : of_tet[tet]];
  }
};

/// Neo-Hookean tissue, the volume's share (lambda) at the centres: for Poisson's ratios above 0.45.
[[nodiscard]] TissueLaws neo_hookean_centred(const LameModuli& moduli);
/// Small-strain linear tissue, likewise.
[[nodiscard]] TissueLaws linear_elastic_centred(const LameModuli& moduli);

/// Tetrahedra of either order with hyperelastic laws; isoparametric.
class ElasticBody final : public Body {
 public:
  /// @param nodes       rest positions [mm]
  /// @param prescribed  as Body's
  /// @throws InputError  names the first tetrahedron with a Jacobian <= 0 or without a law
  ElasticBody(const Topology& topology, const std::vector<Vec3>& nodes, TissueLaws laws,
              std::vector<Vec3> prescribed = {});

  [[nodiscard]] double energy(const Eigen::VectorXd& x) const override;
  void add_derivatives(const Eigen::VectorXd& x, HessianKind kind, Eigen::VectorXd* gradient,
                       std::vector<double>* hessian) const override;
  [[nodiscard]] std::vector<Vec3> nodal_forces(const Eigen::VectorXd& x) const override;
  /// Tetrahedra turned inside out: det F <= 0 at a quadrature point.
  [[nodiscard]] int inverted_tets(const Eigen::VectorXd& x) const;

 private:
  /// Shape gradients of the mesh at one quadrature rule's points.
  struct Points {
    int per_tet = 0;
    std::vector<double> volume;    // [mm^3] weight of each point
    std::vector<double> gradient;  // [1/mm] per point, node by node, three components
  };
  void add_points(const std::vector<Vec3>& nodes, const TetQuadrature& rule);
  [[nodiscard]] const EnergyDensity& law(std::size_t rule, std::size_t tet) const {
    return rule == 0 ? laws_.at(tet) : *laws_.at_centre;
  }
  [[nodiscard]] Mat3 deformation_gradient(const Eigen::VectorXd& x, const Points& points,
                                          std::size_t point) const;
  void add_element_hessian(const Points& points, int tet, const std::vector<Mat9>& tangents,
                           std::vector<double>& hessian) const;

  TissueLaws laws_;
  std::vector<Points> rules_;  // the whole rule, then the centres where a law is integrated there
};

}  // namespace palpate::fem
