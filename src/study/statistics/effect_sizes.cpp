// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/effect_sizes.hpp"

#include <cmath>
#include <limits>

namespace palpate::study::statistics {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
}

double cohen_d(const Moments& a, const Moments& b) {
  if (a.n < 2 || b.n < 2) return kNan;
  const auto da = static_cast<double>(a.n - 1), db = static_cast<double>(b.n - 1);
  const double pooled = std::sqrt((da * a.sd * a.sd + db * b.sd * b.sd) / (da + db));
  return pooled > 0 ? (a.mean - b.mean) / pooled : kNan;
}

double hedges_g(const Moments& a, const Moments& b) {
  const double df = static_cast<double>(a.n + b.n) - 2;
  if (!(df > 1)) return kNan;
  const double unbias =
      std::exp(std::lgamma(0.5 * df) - std::lgamma(0.5 * (df - 1))) / std::sqrt(0.5 * df);
  return unbias * cohen_d(a, b);
}

double standardised_mean(const Moments& sample, double reference) {
  return sample.n > 1 && sample.sd > 0 ? (sample.mean - reference) / sample.sd : kNan;
}

}  // namespace palpate::study::statistics
