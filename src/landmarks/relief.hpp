// SPDX-License-Identifier: GPL-3.0-or-later
// The face as a height map over the head frame's x and y: what a camera in front would measure.
#pragma once
#include <vector>

#include "core/landmarks.hpp"
#include "surface/query.hpp"

namespace palpate::landmarks {

/// Heights z(x, y) [mm] on a grid of step kReliefStep in the head frame, NaN where no skin is seen.
struct Relief {
  double left = 0, low = 0;  ///< [mm] x of column 0, y of row 0
  int columns = 0, rows = 0;
  std::vector<double> z;  ///< [mm] row by row

  [[nodiscard]] double at(int column, int row) const { return z[row * columns + column]; }
  /// Bilinear; NaN outside and next to unseen cells.
  [[nodiscard]] double height(double x, double y) const;
};
inline constexpr double kReliefStep = 1.0;  ///< [mm] finer than any working mesh

struct ReliefArea {
  double x_min, x_max, y_min, y_max;  ///< [mm] head frame
};
/// Rays along -z from in front of everything; the first hit counts.
[[nodiscard]] Relief cast_relief(const surface::SurfaceQuery& skin, const HeadFrame& frame,
                                 const ReliefArea& area);

}  // namespace palpate::landmarks
