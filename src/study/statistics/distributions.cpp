// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/statistics/distributions.hpp"

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace palpate::study::statistics {
namespace {
namespace bm = boost::math;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
}  // namespace

double normal_lower(double z) {
  return std::isnan(z) ? kNan : 0.5 * std::erfc(-z / std::sqrt(2.0));
}

double normal_upper(double z) {
  return normal_lower(-z);
}

double normal_two_sided(double z) {
  return std::isnan(z) ? kNan : std::erfc(std::abs(z) / std::sqrt(2.0));
}

double normal_quantile(double share) {
  return bm::quantile(bm::normal_distribution<double>(), share);
}

double student_two_sided(double t, double df) {
  if (!std::isfinite(t) || !(df > 0)) return kNan;
  return 2 * bm::cdf(bm::complement(bm::students_t_distribution<double>(df), std::abs(t)));
}

double student_quantile(double share, double df) {
  if (!(df > 0)) return kNan;
  return bm::quantile(bm::students_t_distribution<double>(df), share);
}

double fisher_upper(double f, double df_between, double df_within) {
  if (!std::isfinite(f) || f < 0 || !(df_between > 0) || !(df_within > 0)) return kNan;
  return bm::cdf(bm::complement(bm::fisher_f_distribution<double>(df_between, df_within), f));
}

double chi_squared_upper(double x, double df) {
  if (!std::isfinite(x) || x < 0) return kNan;
  return bm::cdf(bm::complement(bm::chi_squared_distribution<double>(df), x));
}

double chi_squared_quantile(double share, double df) {
  return bm::quantile(bm::chi_squared_distribution<double>(df), share);
}

double beta_quantile(double share, double a, double b) {
  return bm::quantile(bm::beta_distribution<double>(a, b), share);
}

}  // namespace palpate::study::statistics
