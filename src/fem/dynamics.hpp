// SPDX-License-Identifier: GPL-3.0-or-later
// Implicit dynamics with Rayleigh damping, stepped until nothing moves any more: the source's way
// to an equilibrium, kept for comparison. Newton (newton.hpp) is the better way.
#pragma once
#include "fem/body.hpp"
#include "fem/cholesky.hpp"

namespace palpate::fem {

/// f_ext = f_int(u) + (alpha M + beta K(u)) v + M a. The source gives none of the figures but the
/// density; those below are our choice. With E = 45.658 kPa and 10 mm of flesh the slowest wave
/// takes 6 ms, so that beta = 10 ms damps every mode beyond oscillation and a load comes to rest
/// within some ten steps.
struct DynamicsOptions {
  double mass_damping = 1.0;        ///< alpha [1/s] >= 0
  double stiffness_damping = 0.01;  ///< beta [s] >= 0
  double time_step = 0.01;          ///< [s] > 0
  int newton_steps = 1;             ///< solves per time step; 1 is usual where speed counts
  double rest_move = 1e-4;          ///< [mm] largest move of a node in a step that counts as rest
  int max_steps = 300;              ///< >= 1
};
struct RestState {
  Eigen::VectorXd x;         ///< unknowns
  bool at_rest = false;      ///< two steps in a row below rest_move
  int steps = 0;             ///< time steps taken
  double residual = 0;       ///< [N] largest static force left on a free node
  int indefinite_steps = 0;  ///< steps whose matrix was not positive definite and was projected
};

/// Mass matrix in the order of the topology's pattern [N s^2/mm], consistent (not lumped).
/// @param density  [N s^2/mm^4] > 0, one per tet; 1 kg/m^3 is 1e-12
[[nodiscard]] std::vector<double> consistent_mass(const Topology& topology,
                                                  const std::vector<Vec3>& nodes,
                                                  std::span<const double> density);

/// From rest at u = 0 under a constant force, Newmark's trapezoidal rule (beta 1/4, gamma 1/2).
/// @param force     over the unknowns [N]
/// @param cholesky  analysed for the body's topology, which has no travel
/// @note Never throws for a motion that does not settle or blows up: `at_rest` says so.
/// @cite Newmark 1959, "A Method of Computation for Structural Dynamics"
[[nodiscard]] RestState step_to_rest(const Body& body, std::span<const double> mass,
                                     const Eigen::VectorXd& force, Cholesky& cholesky,
                                     const DynamicsOptions& options = {});

}  // namespace palpate::fem
