// SPDX-License-Identifier: GPL-3.0-or-later
// A study compares seven regions at a time, so the pairs are simply walked through.
#include "study/statistics/kendall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/error.hpp"
#include "study/statistics/distributions.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

int sign(double x) {
  return (x > 0) - (x < 0);
}

struct Pairs {
  std::vector<double> a, b;
};
Pairs complete(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size())
    throw InputError(fmt::format("two orders differ in length: {} and {}", a.size(), b.size()));
  Pairs out;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::isfinite(a[i]) && std::isfinite(b[i])) out.a.push_back(a[i]), out.b.push_back(b[i]);
  return out;
}

/// Share of the n! orders with at most `most` inversions. Adding the k-th thing makes 0..k-1 new
/// inversions with equal chance 1/k, so the shares stay numbers near 1 where n! would not.
double share_of_orders(std::size_t n, std::size_t most) {
  std::vector<double> share(n * (n - 1) / 2 + 1, 0.0);
  share[0] = 1;
  for (std::size_t k = 2; k <= n; ++k) {
    std::vector<double> next(share.size(), 0.0);
    for (std::size_t c = 0; c <= k * (k - 1) / 2; ++c)
      for (std::size_t added = 0; added < std::min(k, c + 1); ++added)
        next[c] += share[c - added] / static_cast<double>(k);
    share = std::move(next);
  }
  return std::accumulate(share.begin(), share.begin() + static_cast<std::ptrdiff_t>(most) + 1, 0.0);
}

/// Sums over the groups of equal values of t(t-1), t(t-1)(t-2) and t(t-1)(2t+5).
struct TieSums {
  double pairs = 0, triples = 0, variance = 0;
};
TieSums tie_sums(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  TieSums out;
  for (std::size_t from = 0; from < values.size();) {
    std::size_t to = from + 1;
    while (to < values.size() && values[to] == values[from]) ++to;
    const auto t = static_cast<double>(to - from);
    out.pairs += t * (t - 1);
    out.triples += t * (t - 1) * (t - 2);
    out.variance += t * (t - 1) * (2 * t + 5);
    from = to;
  }
  return out;
}

/// Of concordant - discordant, under no association.
double variance(const TieSums& a, const TieSums& b, double n) {
  double v = (n * (n - 1) * (2 * n + 5) - a.variance - b.variance) / 18;
  v += a.pairs * b.pairs / (2 * n * (n - 1));
  if (n > 2) v += a.triples * b.triples / (9 * n * (n - 1) * (n - 2));
  return v;
}

}  // namespace

Kendall kendall(std::span<const double> a_values, std::span<const double> b_values) {
  const Pairs x = complete(a_values, b_values);
  const std::size_t n = x.a.size();
  Kendall out;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int way = sign(x.a[i] - x.a[j]) * sign(x.b[i] - x.b[j]);
      ++(way > 0 ? out.concordant : way < 0 ? out.discordant : out.tied);
    }
  const TieSums a = tie_sums(x.a), b = tie_sums(x.b);
  const double pairs = static_cast<double>(n) * (static_cast<double>(n) - 1);
  const double scale = std::sqrt((pairs - a.pairs) * (pairs - b.pairs));
  if (n < 2 || !(scale > 0)) {
    out.tau_b = out.p = out.z = kNan;
    return out;
  }
  const double balance = static_cast<double>(out.concordant) - static_cast<double>(out.discordant);
  out.tau_b = 2 * balance / scale;
  if (out.tied == 0 && n <= kLargestExactKendall) {
    out.form = RankForm::exact;
    out.z = kNan;
    out.p = std::min(1.0, 2 * share_of_orders(n, std::min(out.concordant, out.discordant)));
    return out;
  }
  out.form = RankForm::normal;
  out.z = balance / std::sqrt(variance(a, b, static_cast<double>(n)));
  out.p = normal_two_sided(out.z);
  return out;
}

double pair_accuracy(std::span<const double> ratings, std::span<const double> reference) {
  const Pairs x = complete(ratings, reference);
  std::size_t all = 0, right = 0;
  for (std::size_t i = 0; i < x.a.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int wanted = sign(x.b[i] - x.b[j]);
      if (wanted == 0) continue;
      ++all;
      right += sign(x.a[i] - x.a[j]) != -wanted;
    }
  return all == 0 ? kNan : static_cast<double>(right) / static_cast<double>(all);
}

}  // namespace palpate::study::statistics
