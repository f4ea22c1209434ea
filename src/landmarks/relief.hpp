// SPDX-License-Identifier: GPL-3.0-or-later
// The face as a height map over the head frame's x and y: what a camera in front would measure.
#pragma once
#include <vector>

#include "core/landmarks.hpp"
#include "surface/query.hpp"

namespace palpate::landmarks {

/// Heights z(x, y) [mm] on a grid in the head frame, NaN where no skin is seen.
struct Relief {
  double step = 1;           ///< [mm]
  double left = 0, low = 0;  ///< [mm] x of column 0, y of row 0
  int columns = 0, rows = 0;
  std::vector<double> z;  ///< [mm] row by row

  [[nodiscard]] double x(int column) const { return left + column * step; }
  [[nodiscard]] double y(int row) const { return low + row * step; }
  [[nodiscard]] double at(int column, int row) const { return z[row * columns + column]; }
  /// Bilinear; NaN outside and next to unseen cells.
  [[nodiscard]] double height(double x, double y) const;
};

struct ReliefArea {
  double x_min, x_max, y_min, y_max;  ///< [mm] head frame
};
/// Rays along -z from in front of everything; the first hit counts.
[[nodiscard]] Relief cast_relief(const surface::SurfaceQuery& skin, const HeadFrame& frame,
                                 const ReliefArea& area, double step = 1);

}  // namespace palpate::landmarks
