// SPDX-License-Identifier: GPL-3.0-or-later
// Minimiser of a smooth potential: projected Newton with backtracking.
#pragma once
#include "fem/body.hpp"
#include "fem/cholesky.hpp"

namespace palpate::fem {

/// What Newton needs to know. Values may be kInadmissible; derivatives are asked for only where the
/// value is finite.
class Potential {
 public:
  virtual ~Potential() = default;
  [[nodiscard]] virtual double value(const Eigen::VectorXd& x) const = 0;              ///< [N mm]
  [[nodiscard]] virtual Eigen::VectorXd gradient(const Eigen::VectorXd& x) const = 0;  ///< [N]
  virtual void hessian(const Eigen::VectorXd& x, HessianKind kind,
                       std::vector<double>& values) const = 0;  ///< [N/mm] overwrites
};

struct NewtonOptions {
  double force_tolerance = 1e-6;  ///< [N] largest entry left of the gradient; > 0
  int max_iterations = 60;        ///< >= 1
};
struct NewtonResult {
  Eigen::VectorXd x;
  double residual = 0;  ///< [N] largest entry of the gradient
  int iterations = 0;
  int projections = 0;  ///< iterations that needed the projected Hessian
};

/// From an admissible x0 down to a stationary point. Each step solves with the exact Hessian, or
/// with the projected one where that is not positive definite, and is halved until the value falls.
/// @throws SolveError  tolerance not reached; carries residual [N] and iterations
[[nodiscard]] NewtonResult minimise(const Potential& potential, Eigen::VectorXd x0,
                                    Cholesky& cholesky, const NewtonOptions& options = {});

}  // namespace palpate::fem
