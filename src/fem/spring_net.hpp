// SPDX-License-Identifier: GPL-3.0-or-later
// A mass-spring net on the edges of a tetrahedral mesh: the cheap model that finite elements are
// weighed against.
#pragma once
#include "fem/body.hpp"

namespace palpate::fem {

/// Springs that are straight at rest; energy sum k_e/2 (length - rest length)^2. The stiffness of
/// an edge is E sum(volume of its tets) / rest length^2, which gives a bar its Young's modulus; the
/// net's Poisson's ratio is near 1/4 whatever the tissue's is, and no spring minds an inverted
/// tetrahedron.
/// @cite Van Gelder 1998, "Approximate Simulation of Elastic Membranes by Triangulated Spring
/// Meshes", section 4
class SpringNet final : public Body {
 public:
  /// @param topology        linear
  /// @param nodes           rest positions [mm]
  /// @param youngs_modulus  [MPa] > 0
  /// @throws InputError for a quadratic mesh or a modulus <= 0
  SpringNet(const Topology& topology, const std::vector<Vec3>& nodes, double youngs_modulus,
            std::vector<Vec3> prescribed = {});

  [[nodiscard]] double energy(const Eigen::VectorXd& x) const override;
  /// `projected` drops the negative stiffness across a shortened spring.
  void add_derivatives(const Eigen::VectorXd& x, HessianKind kind, Eigen::VectorXd* gradient,
                       std::vector<double>* hessian) const override;
  [[nodiscard]] std::vector<Vec3> nodal_forces(const Eigen::VectorXd& x) const override;

 private:
  struct Spring {
    std::int32_t a, b;
    double rest;       // [mm]
    double stiffness;  // [N/mm]
  };
  [[nodiscard]] Vec3 edge(const Eigen::VectorXd& x, const Spring& s) const;

  const std::vector<Vec3>& nodes_;
  std::vector<Spring> springs_;
};

}  // namespace palpate::fem
