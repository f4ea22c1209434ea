// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/relief.hpp"

#include <cmath>
#include <limits>

namespace palpate::landmarks {

Relief cast_relief(const surface::SurfaceQuery& skin, const HeadFrame& frame,
                   const ReliefArea& area, double step) {
  constexpr double kInFront = 150;  // [mm] before the eyes: no nose is longer
  Relief map;
  map.step = step;
  map.left = area.x_min;
  map.low = area.y_min;
  map.columns = static_cast<int>(std::floor((area.x_max - area.x_min) / step)) + 1;
  map.rows = static_cast<int>(std::floor((area.y_max - area.y_min) / step)) + 1;
  map.z.assign(static_cast<std::size_t>(map.columns) * map.rows,
               std::numeric_limits<double>::quiet_NaN());
  const Vec3 backwards = -frame.rotation.row(2).transpose();
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const Vec3 from(map.x(column), map.y(row), kInFront);
      const auto hit = skin.cast(frame.to_scan(from), backwards);
      if (hit) map.z[row * map.columns + column] = kInFront - hit->distance;
    }
  }
  return map;
}

double Relief::height(double x, double y) const {
  const double u = (x - left) / step, v = (y - low) / step;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  if (i < 0 || j < 0 || i + 1 >= columns || j + 1 >= rows) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
         b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

}  // namespace palpate::landmarks
