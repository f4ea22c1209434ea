// SPDX-License-Identifier: Apache-2.0
// Source eq. 4.12 and 4.13; b_i is taken at the upper sample, which makes neighbouring pieces meet:
// k_i u_i + b_i = f_i and k_i u_(i-1) + b_i = f_(i-1).
#include "core/stiffness_map.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace palpate {

StiffnessCoefficients stiffness_coefficients(std::span<const double> forces,
                                             std::span<const double> u) {
  if (forces.size() != u.size())
    throw InputError(fmt::format("a curve has {} forces but {} travels", forces.size(), u.size()));
  StiffnessCoefficients c;
  double f0 = 0;
  double u0 = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (!(u[i] > u0)) throw InputError(fmt::format("travel {} of a curve does not ascend", i + 1));
    c.k.push_back((forces[i] - f0) / (u[i] - u0));
    c.b.push_back(i == 0 ? 0.0 : forces[i] - c.k.back() * u[i]);
    f0 = forces[i];
    u0 = u[i];
  }
  return c;
}

double force_at(const StiffnessCoefficients& c, std::span<const double> u_samples, double u) {
  if (!(u > 0) || c.k.empty()) return 0;
  std::size_t i = 0;
  while (i + 1 < c.k.size() && u >= u_samples[i]) ++i;
  return c.k[i] * u + c.b[i];
}

}  // namespace palpate
