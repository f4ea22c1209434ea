// SPDX-License-Identifier: GPL-3.0-or-later
// Nocedal & Wright 2006, "Numerical Optimization", chapter 3 (backtracking, Hessian modification).
#include "fem/newton.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

constexpr double kArmijo = 1e-4;         // [-] share of the predicted decrease that must come
constexpr int kMostHalvings = 40;        // a step of 1e-12 is no step
constexpr double kRoundOff = 1e-13;      // [-] of the value: smaller changes cannot be seen
constexpr double kSmallestShift = 1e-6;  // [-] of the mean diagonal, when projection is not enough
constexpr double kLargestShift = 1e6;    // [-]

[[noreturn]] void fail(const char* what, double residual, int iterations) {
  throw SolveError(
      fmt::format("{}: residual {:.3g} N after {} iterations", what, residual, iterations),
      residual, iterations);
}

/// Factorises exact, projected, then shifted Hessians until one is positive definite.
bool factorize_some(const Potential& potential, const Eigen::VectorXd& x, Cholesky& cholesky,
                    const SparsePattern& pattern, std::vector<double>& values) {
  potential.hessian(x, HessianKind::exact, values);
  if (cholesky.factorize(values)) return true;
  potential.hessian(x, HessianKind::projected, values);
  if (cholesky.factorize(values)) return false;
  double mean = 0;
  for (int c = 0; c < pattern.size; ++c) mean += values[pattern.column_start[c]] / pattern.size;
  for (double shift = kSmallestShift; shift < kLargestShift; shift *= 100) {
    for (int c = 0; c < pattern.size; ++c) values[pattern.column_start[c]] += shift * mean;
    if (cholesky.factorize(values)) return false;
  }
  throw SolveError("no positive definite Hessian found");
}

/// Step length in (0, 1], or 0 where no decrease was found.
double backtrack(const Potential& potential, const Eigen::VectorXd& x, const Eigen::VectorXd& step,
                 double value, double slope) {
  double t = 1;
  for (int i = 0; i < kMostHalvings; ++i, t *= 0.5) {
    const double trial = potential.value(x + t * step);
    if (trial <= value + kArmijo * t * slope) return t;
    const bool below_round_off = -t * slope < kRoundOff * std::abs(value);
    if (below_round_off && trial <= value + kRoundOff * std::abs(value)) return t;
  }
  return 0;
}

}  // namespace

NewtonResult minimise(const Potential& potential, Eigen::VectorXd x0, Cholesky& cholesky,
                      const NewtonOptions& options) {
  NewtonResult r;
  r.x = std::move(x0);
  double value = potential.value(r.x);
  if (!std::isfinite(value)) fail("Newton started from an inadmissible state", kInadmissible, 0);
  std::vector<double> hessian(cholesky.pattern().row.size());
  while (true) {
    const Eigen::VectorXd gradient = potential.gradient(r.x);
    r.residual = gradient.lpNorm<Eigen::Infinity>();
    if (r.residual <= options.force_tolerance) return r;
    if (r.iterations == options.max_iterations || !std::isfinite(r.residual))
      fail("Newton did not reach its tolerance", r.residual, r.iterations);
    if (!factorize_some(potential, r.x, cholesky, cholesky.pattern(), hessian)) ++r.projections;
    const Eigen::VectorXd step = -cholesky.solve(gradient);
    const double t = backtrack(potential, r.x, step, value, gradient.dot(step));
    if (t == 0) fail("Newton's line search found no decrease", r.residual, r.iterations);
    r.x += t * step;
    value = potential.value(r.x);
    ++r.iterations;
  }
}

}  // namespace palpate::fem
