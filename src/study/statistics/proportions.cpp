// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/proportions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "study/statistics/distributions.hpp"

namespace palpate::study::statistics {
namespace {

/// The shares p with |share - p| <= z sqrt(p (1 - p) / n): the roots of a quadratic in p.
Interval wilson(double k, double n, double z) {
  const double share = k / n;
  const double middle = (share + z * z / (2 * n)) / (1 + z * z / n);
  const double half =
      z / (1 + z * z / n) * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
  // At the ends one root is 0 or 1; the subtraction would leave rounding there.
  return {k == 0 ? 0.0 : std::max(0.0, middle - half), k == n ? 1.0 : std::min(1.0, middle + half)};
}

/// Each side holds the share at which the observed count or a more extreme one has `tail`.
Interval clopper_pearson(double k, double n, double tail) {
  return {k == 0 ? 0.0 : beta_quantile(tail, k, n - k + 1),
          k == n ? 1.0 : beta_quantile(1 - tail, k + 1, n - k)};
}

}  // namespace

Proportion proportion(std::size_t successes, std::size_t trials, double confidence) {
  if (successes > trials)
    throw InputError(fmt::format("a share of {} successes in {} trials", successes, trials));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (trials == 0) return {0, 0, kNan, {kNan, kNan}, {kNan, kNan}};
  const auto k = static_cast<double>(successes), n = static_cast<double>(trials);
  return {successes, trials, k / n, wilson(k, n, normal_quantile(0.5 + 0.5 * confidence)),
          clopper_pearson(k, n, 0.5 - 0.5 * confidence)};
}

}  // namespace palpate::study::statistics
