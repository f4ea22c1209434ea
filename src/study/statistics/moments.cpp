// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/moments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/statistics/distributions.hpp"

namespace palpate::study::statistics {
namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
}

std::vector<double> numbers(std::span<const double> values) {
  std::vector<double> kept;
  kept.reserve(values.size());
  for (const double v : values)
    if (std::isfinite(v)) kept.push_back(v);
  return kept;
}

Moments moments(std::span<const double> values) {
  Moments out{0, 0, 0};
  for (const double v : values)
    if (std::isfinite(v)) {
      out.mean += v;
      ++out.n;
    }
  if (out.n == 0) return {0, kNan, kNan};
  out.mean /= static_cast<double>(out.n);
  if (out.n == 1) return {1, out.mean, kNan};
  // The second sum is zero in exact arithmetic; it takes back the rounding of the mean.
  double squares = 0, rest = 0;
  for (const double v : values)
    if (std::isfinite(v)) {
      squares += (v - out.mean) * (v - out.mean);
      rest += v - out.mean;
    }
  squares -= rest * rest / static_cast<double>(out.n);
  out.sd = std::sqrt(std::max(0.0, squares) / static_cast<double>(out.n - 1));
  return out;
}

Moments combined(std::span<const Moments> groups) {
  Moments all{0, 0, 0};
  for (const Moments& g : groups) {
    if (g.n == 0) continue;
    all.n += g.n;
    all.mean += static_cast<double>(g.n) * g.mean;
  }
  if (all.n == 0) return {0, kNan, kNan};
  all.mean /= static_cast<double>(all.n);
  // Sum of squares about the common mean = within the groups + between their means.
  double squares = 0;
  for (const Moments& g : groups) {
    if (g.n == 0) continue;
    const double away = g.mean - all.mean;
    squares += static_cast<double>(g.n) * away * away;
    if (g.n > 1) squares += static_cast<double>(g.n - 1) * g.sd * g.sd;
  }
  all.sd = all.n < 2 ? kNan : std::sqrt(squares / static_cast<double>(all.n - 1));
  return all;
}

Interval mean_interval(const Moments& sample, double confidence) {
  if (sample.n < 2) return {kNan, kNan};
  const auto n = static_cast<double>(sample.n);
  const double half = student_quantile(0.5 + 0.5 * confidence, n - 1) * sample.sd / std::sqrt(n);
  return {sample.mean - half, sample.mean + half};
}

double quantile(std::span<const double> values, double q) {
  std::vector<double> sorted = numbers(values);
  if (sorted.empty()) return kNan;
  std::sort(sorted.begin(), sorted.end());
  const double at = std::clamp(q, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= sorted.size()) return sorted.back();
  return sorted[i] + (at - static_cast<double>(i)) * (sorted[i + 1] - sorted[i]);
}

double median(std::span<const double> values) {
  return quantile(values, 0.5);
}

}  // namespace palpate::study::statistics
