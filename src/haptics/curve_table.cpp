// SPDX-License-Identifier: Apache-2.0
#include "haptics/curve_table.hpp"

#include <algorithm>

namespace palpate::haptics {

template <bool kEnergy>
CurveValue CurveTable::evaluate(std::int32_t row, double d) const {
  if (!(d > 0)) return {};
  const double* u = travel.data() + static_cast<std::size_t>(row) * knots;
  const double* f =
      force.size() == knots ? force.data() : force.data() + static_cast<std::size_t>(row) * knots;
  // No branch depends on the travel: it would be guessed wrong at each tick that changes piece.
  std::size_t i = 0;
  for (std::size_t j = 0; j + 1 < knots; ++j) i += d >= u[j] ? 1 : 0;
  const double u0 = i ? u[i - 1] : 0;
  const double f0 = i ? f[i - 1] : 0;
  const double k = (f[i] - f0) / (u[i] - u0);
  const double value = f0 + k * (d - u0);
  double energy = 0;
  if constexpr (kEnergy) {
    energy = 0.5 * (value + f0) * (d - u0);
    if (i) energy += 0.5 * f[0] * u[0];
    for (std::size_t j = 1; j < knots; ++j)
      energy += j < i ? 0.5 * (f[j] + f[j - 1]) * (u[j] - u[j - 1]) : 0;
  }
  return {value, k, energy};
}
template CurveValue CurveTable::evaluate<true>(std::int32_t, double) const;

template <bool kEnergy>
CurveValue CurveTable::blend_rows(const Triangle& corners, const Vec3& weights, double d) const {
  CurveValue sum;
  for (int k = 0; k < 3; ++k) {
    if (weights[k] == 0) continue;
    const CurveValue v = evaluate<kEnergy>(corners[k], d);
    sum.force += weights[k] * v.force;
    sum.stiffness += weights[k] * v.stiffness;
    sum.energy += weights[k] * v.energy;
  }
  return sum;
}

CurveValue CurveTable::blend(const Triangle& corners, const Vec3& weights, double d) const {
  return blend_rows<true>(corners, weights, d);
}
CurveValue CurveTable::blend_force(const Triangle& corners, const Vec3& weights, double d) const {
  return blend_rows<false>(corners, weights, d);
}

bool exceeds(const CurveTable& curves, double scale, double steepest) {
  const auto rows = static_cast<std::int32_t>(curves.rows());
  for (std::int32_t row = 0; row < rows; ++row)
    for (std::size_t i = 0; i < curves.knots; ++i) {
      const double u = curves.travel[static_cast<std::size_t>(row) * curves.knots + i];
      if (scale * curves.at(row, u).stiffness > steepest) return true;
      // `at` reads the piece that starts at u; the first piece starts at 0.
      if (i == 0 && scale * curves.at(row, 0.5 * u).stiffness > steepest) return true;
    }
  return false;
}

CurveTable limited(const CurveTable& curves, double scale, double steepest) {
  CurveTable out{curves.knots, curves.travel, std::vector<double>(curves.travel.size())};
  const bool shared = curves.force.size() == curves.knots;
  for (std::size_t row = 0; row < curves.rows(); ++row) {
    double u0 = 0;
    double f0 = 0;
    double limited0 = 0;
    for (std::size_t i = 0; i < curves.knots; ++i) {
      const std::size_t at = row * curves.knots + i;
      const double f = scale * curves.force[shared ? i : at];
      const double slope = (f - f0) / (curves.travel[at] - u0);
      limited0 += std::min(slope, steepest) * (curves.travel[at] - u0);
      out.force[at] = limited0;
      u0 = curves.travel[at];
      f0 = f;
    }
  }
  return out;
}

}  // namespace palpate::haptics
