// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/t_tests.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "study/statistics/distributions.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TTest finish(double difference, double standard_error, double df, double confidence) {
  if (!(standard_error > 0) || !(df > 0)) return {kNan, kNan, kNan, difference, {kNan, kNan}};
  const double t = difference / standard_error;
  const double half = student_quantile(0.5 + 0.5 * confidence, df) * standard_error;
  return {t, df, student_two_sided(t, df), difference, {difference - half, difference + half}};
}

}  // namespace

TTest one_sample_t(const Moments& sample, double reference, double confidence) {
  const auto n = static_cast<double>(sample.n);
  return finish(sample.mean - reference, sample.sd / std::sqrt(n), n - 1, confidence);
}

std::vector<double> differences(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size())
    throw InputError(fmt::format("paired samples differ in length: {} and {}", a.size(), b.size()));
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) out.push_back(a[i] - b[i]);
  return out;
}

TTest paired_t(std::span<const double> a, std::span<const double> b, double confidence) {
  return one_sample_t(moments(differences(a, b)), 0, confidence);
}

TTest welch_t(const Moments& a, const Moments& b, double confidence) {
  if (a.n < 2 || b.n < 2) return finish(a.mean - b.mean, kNan, kNan, confidence);
  const auto na = static_cast<double>(a.n), nb = static_cast<double>(b.n);
  const double va = a.sd * a.sd / na, vb = b.sd * b.sd / nb;
  const double df = (va + vb) * (va + vb) / (va * va / (na - 1) + vb * vb / (nb - 1));
  return finish(a.mean - b.mean, std::sqrt(va + vb), df, confidence);
}

}  // namespace palpate::study::statistics
