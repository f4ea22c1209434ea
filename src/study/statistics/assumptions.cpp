// SPDX-License-Identifier: GPL-3.0-or-later
// Shapiro & Wilk: W compares the spread that the sorted values would have on a normal line with the
// spread they have. The best weights need the covariances of normal order statistics; Royston 1995
// gives polynomials in 1/sqrt(n) for the two outermost weights, takes the others proportional to
// Blom's scores, and fits ln(1 - W) by a normal distribution (n = 3 has a closed form).
#include "study/statistics/assumptions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/statistics/distributions.hpp"
#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <std::size_t N>
double polynomial(const std::array<double, N>& c, double x) {
  double out = 0;
  for (std::size_t i = N; i-- > 0;) out = out * x + c[i];
  return out;
}

// Royston 1995, table 1.
constexpr std::array<double, 6> kOuterWeight = {0,        .221157,  -.147981,
                                                -2.07119, 4.434685, -2.706056};
constexpr std::array<double, 6> kSecondWeight = {0,         .042981,  -.293762,
                                                 -1.752461, 5.682633, -3.582633};
constexpr std::array<double, 2> kSmallBound = {-2.273, .459};
constexpr std::array<double, 4> kSmallMean = {.544, -.39978, .025054, -6.714e-4};
constexpr std::array<double, 4> kSmallLogSd = {1.3822, -.77857, .062767, -.0020322};
constexpr std::array<double, 4> kLargeMean = {-1.5861, -.31082, -.083751, .0038915};
constexpr std::array<double, 3> kLargeLogSd = {-.4803, -.082676, .0030302};

/// Weights of the upper half, outermost first; the lower half mirrors them with the other sign.
std::vector<double> weights(std::size_t n) {
  const std::size_t half = n / 2;
  if (n == 3) return {std::sqrt(0.5)};
  std::vector<double> score(half);
  double squares = 0;
  for (std::size_t i = 0; i < half; ++i) {
    score[i] =
        -normal_quantile((static_cast<double>(i) + 1 - 0.375) / (static_cast<double>(n) + 0.25));
    squares += 2 * score[i] * score[i];
  }
  const double root = 1 / std::sqrt(static_cast<double>(n)), length = std::sqrt(squares);
  std::vector<double> a(half);
  a[0] = score[0] / length + polynomial(kOuterWeight, root);
  double left = squares - 2 * score[0] * score[0], share = 1 - 2 * a[0] * a[0];
  std::size_t fixed = 1;
  if (n > 5) {
    a[1] = score[1] / length + polynomial(kSecondWeight, root);
    left -= 2 * score[1] * score[1];
    share -= 2 * a[1] * a[1];
    fixed = 2;
  }
  const double scale = std::sqrt(left / share);
  for (std::size_t i = fixed; i < half; ++i) a[i] = score[i] / scale;
  return a;
}

double shapiro_wilk_p(double w, double one_minus_w, std::size_t n) {
  const auto count = static_cast<double>(n);
  if (n == 3) {
    const double p = 6 / std::numbers::pi * (std::asin(std::sqrt(w)) - std::asin(std::sqrt(0.75)));
    return std::clamp(p, 0.0, 1.0);
  }
  double y = std::log(one_minus_w), mean = 0, sd = 1;
  if (n <= 11) {
    const double bound = polynomial(kSmallBound, count);
    if (y >= bound) return 0;
    y = -std::log(bound - y);
    mean = polynomial(kSmallMean, count);
    sd = std::exp(polynomial(kSmallLogSd, count));
  } else {
    mean = polynomial(kLargeMean, std::log(count));
    sd = std::exp(polynomial(kLargeLogSd, std::log(count)));
  }
  return normal_upper((y - mean) / sd);
}

/// |value - median|.
std::vector<double> deviations(const std::vector<double>& values) {
  const double middle = median(values);
  std::vector<double> out;
  for (const double v : values) out.push_back(std::abs(v - middle));
  return out;
}

}  // namespace

ShapiroWilk shapiro_wilk(std::span<const double> values) {
  std::vector<double> x = numbers(values);
  const std::size_t n = x.size();
  if (n < 3 || n > 5000) return {kNan, kNan};
  std::sort(x.begin(), x.end());
  if (!(x.back() > x.front())) return {kNan, kNan};
  const std::vector<double> a = weights(n);
  double product = 0, weight_squares = 0, squares = 0;
  const double mean = moments(x).mean;
  for (std::size_t i = 0; i < a.size(); ++i) {
    product += a[i] * (x[n - 1 - i] - x[i]);
    weight_squares += 2 * a[i] * a[i];
  }
  for (const double v : x) squares += (v - mean) * (v - mean);
  // 1 - W as a product: it keeps its digits where W is near 1.
  const double spread = std::sqrt(weight_squares * squares);
  const double one_minus_w = (spread - product) * (spread + product) / (weight_squares * squares);
  return {1 - one_minus_w, shapiro_wilk_p(1 - one_minus_w, one_minus_w, n)};
}

SpreadTest brown_forsythe(std::span<const double> a_values, std::span<const double> b_values) {
  const std::vector<double> a = numbers(a_values), b = numbers(b_values);
  if (a.size() < 2 || b.size() < 2) return {kNan, kNan, kNan};
  const double va = std::pow(moments(a).sd, 2), vb = std::pow(moments(b).sd, 2);
  const Moments da = moments(deviations(a)), db = moments(deviations(b));
  const auto na = static_cast<double>(a.size()), nb = static_cast<double>(b.size());
  const double grand = (na * da.mean + nb * db.mean) / (na + nb);
  const double between = na * std::pow(da.mean - grand, 2) + nb * std::pow(db.mean - grand, 2);
  const double within = (na - 1) * da.sd * da.sd + (nb - 1) * db.sd * db.sd;
  SpreadTest out{kNan, kNan, std::min(va, vb) > 0 ? std::max(va, vb) / std::min(va, vb) : kNan};
  if (!(within > 0)) return out;
  out.f = between / (within / (na + nb - 2));
  out.p = fisher_upper(out.f, 1, na + nb - 2);
  return out;
}

}  // namespace palpate::study::statistics
