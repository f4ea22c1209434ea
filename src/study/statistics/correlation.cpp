// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "study/statistics/distributions.hpp"
#include "study/statistics/ranks.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Complete pairs and their sums of squares and products about the means.
struct Products {
  std::vector<double> x, y;
  double mean_x = 0, mean_y = 0, xx = 0, yy = 0, xy = 0;
};

Products products(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size())
    throw InputError(
        fmt::format("correlated samples differ in length: {} and {}", x.size(), y.size()));
  Products out;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && std::isfinite(y[i])) out.x.push_back(x[i]), out.y.push_back(y[i]);
  out.mean_x = moments(out.x).mean;
  out.mean_y = moments(out.y).mean;
  for (std::size_t i = 0; i < out.x.size(); ++i) {
    const double dx = out.x[i] - out.mean_x, dy = out.y[i] - out.mean_y;
    out.xx += dx * dx;
    out.yy += dy * dy;
    out.xy += dx * dy;
  }
  return out;
}

Correlation of(const Products& s, double confidence) {
  Correlation out{s.x.size(), kNan, kNan, {kNan, kNan}};
  if (out.n < 3 || !(s.xx > 0) || !(s.yy > 0)) return out;
  const auto n = static_cast<double>(out.n);
  // One root: where both sides are the same numbers it gives their sum back, and r is exactly 1.
  out.r = std::clamp(s.xy / std::sqrt(s.xx * s.yy), -1.0, 1.0);
  const double rest = (1 - out.r) * (1 + out.r);
  out.p = rest > 0 ? student_two_sided(out.r * std::sqrt((n - 2) / rest), n - 2) : 0.0;
  if (out.n > 3) {
    const double z = std::atanh(out.r);
    const double half = normal_quantile(0.5 + 0.5 * confidence) / std::sqrt(n - 3);
    out.interval = {std::tanh(z - half), std::tanh(z + half)};
  }
  return out;
}

}  // namespace

Correlation pearson(std::span<const double> x, std::span<const double> y, double confidence) {
  return of(products(x, y), confidence);
}

Correlation spearman(std::span<const double> x, std::span<const double> y, double confidence) {
  const Products pairs = products(x, y);
  const Ranks rx = mid_ranks(pairs.x), ry = mid_ranks(pairs.y);
  return of(products(rx.rank, ry.rank), confidence);
}

Line fitted_line(std::span<const double> x, std::span<const double> y) {
  const Products s = products(x, y);
  if (!(s.xx > 0)) return {kNan, kNan};
  const double slope = s.xy / s.xx;
  return {s.mean_y - slope * s.mean_x, slope};
}

}  // namespace palpate::study::statistics
