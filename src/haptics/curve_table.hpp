// SPDX-License-Identifier: Apache-2.0
// Force-travel curves of all points in one flat table, read by the tick.
#pragma once
#include <cstdint>
#include <vector>

#include "core/types.hpp"

namespace palpate::haptics {

/// What a curve says at one travel.
struct CurveValue {
  double force = 0;      ///< [N]
  double stiffness = 0;  ///< [N/mm] slope of the piece
  double energy = 0;     ///< [N mm] area under the curve from 0
};

/// Rows of (travel, force) knots; straight between the knots, from (0, 0) to the first, and beyond
/// the last with the last slope. It is core's f = k u + b (stiffness_map.hpp) written with the
/// knots, which differs from k u + b by rounding only.
struct CurveTable {
  std::size_t knots = 0;       ///< per row, >= 1
  std::vector<double> travel;  ///< [mm] rows x knots, ascending in a row, > 0
  std::vector<double> force;   ///< [N] rows x knots, or one row that all share

  [[nodiscard]] std::size_t rows() const { return knots ? travel.size() / knots : 0; }
  /// One row at travel `d` [mm]; zero for d <= 0. Allocates nothing.
  [[nodiscard]] CurveValue at(std::int32_t row, double d) const { return evaluate<true>(row, d); }
  /// The curves of a triangle's corners, each at `d`, blended with barycentric weights.
  [[nodiscard]] CurveValue blend(const Triangle& corners, const Vec3& weights, double d) const;
  /// The same with energy 0: half the work.
  [[nodiscard]] CurveValue blend_force(const Triangle& corners, const Vec3& weights,
                                       double d) const;

 private:
  template <bool kEnergy>
  [[nodiscard]] CurveValue evaluate(std::int32_t row, double d) const;
  template <bool kEnergy>
  [[nodiscard]] CurveValue blend_rows(const Triangle& corners, const Vec3& weights, double d) const;
};

/// The same curves for a device: forces times `scale`, then no slope above `steepest` [N/mm];
/// steeper pieces go on with that slope, so the curve stays continuous and never exceeds the scaled
/// one.
[[nodiscard]] CurveTable limited(const CurveTable& curves, double scale, double steepest);
/// True when limited() with the same arguments changes a force somewhere other than by `scale`.
[[nodiscard]] bool exceeds(const CurveTable& curves, double scale, double steepest);

}  // namespace palpate::haptics
