// SPDX-License-Identifier: GPL-3.0-or-later
// Exact forms count arrangements. Mann-Whitney: orders of na and nb values that reach U. Wilcoxon:
// subsets of {1..n} with sum w. Counts are sums of positive terms, so nothing cancels, and up to
// kLargestExactSample a double carries them to a relative 1e-13.
#include "study/statistics/ranks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "study/statistics/distributions.hpp"
#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Arrangements of na and nb values by their U: count[na][u] grows one value of b at a time, since
/// the largest of all is an a (which beats all nb of b) or a b.
std::vector<double> mann_whitney_counts(std::size_t na, std::size_t nb) {
  std::vector<std::vector<double>> count(na + 1);
  for (std::size_t i = 0; i <= na; ++i) count[i] = {1.0};
  for (std::size_t j = 1; j <= nb; ++j)
    for (std::size_t i = 1; i <= na; ++i) {
      // count[i] still holds j - 1 of b; count[i - 1] already j.
      std::vector<double> next(i * j + 1, 0.0);
      for (std::size_t u = 0; u < count[i].size(); ++u) next[u] += count[i][u];
      for (std::size_t u = 0; u < count[i - 1].size(); ++u) next[u + j] += count[i - 1][u];
      count[i] = std::move(next);
    }
  return count[na];
}

std::vector<double> signed_rank_counts(std::size_t n) {
  std::vector<double> count(n * (n + 1) / 2 + 1, 0.0);
  count[0] = 1;
  for (std::size_t k = 1; k <= n; ++k)
    for (std::size_t w = k * (k + 1) / 2; w >= k; --w) count[w] += count[w - k];
  return count;
}

/// Twice the share of arrangements at or below `low`, the smaller of the two statistics.
double two_sided(const std::vector<double>& count, double low) {
  const auto last = static_cast<std::size_t>(low + 0.5);
  const double all = std::accumulate(count.begin(), count.end(), 0.0);
  const double tail =
      std::accumulate(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(last) + 1, 0.0);
  return std::min(1.0, 2 * tail / all);
}

}  // namespace

std::string_view words(RankForm form) {
  switch (form) {
    case RankForm::exact:
      return "exact";
    case RankForm::normal:
      return "normal approximation, corrected for ties and continuity";
    case RankForm::none:
      break;
  }
  return "no test";
}

Ranks mid_ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
  Ranks out{std::vector<double>(values.size()), 0};
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from + 1;
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    const auto t = static_cast<double>(to - from);
    for (std::size_t k = from; k < to; ++k)
      out.rank[order[k]] = static_cast<double>(from) + 0.5 * (t + 1);
    out.tie_cubes += t * t * t - t;
    from = to;
  }
  return out;
}

MannWhitney mann_whitney(std::span<const double> a_values, std::span<const double> b_values) {
  const std::vector<double> a = numbers(a_values), b = numbers(b_values);
  if (a.empty() || b.empty()) return {kNan, kNan, kNan, kNan};
  std::vector<double> all = a;
  all.insert(all.end(), b.begin(), b.end());
  const Ranks ranks = mid_ranks(all);
  const auto na = static_cast<double>(a.size()), nb = static_cast<double>(b.size());
  const auto a_end = ranks.rank.begin() + static_cast<std::ptrdiff_t>(a.size());

  MannWhitney out;
  out.u = std::accumulate(ranks.rank.begin(), a_end, 0.0) - 0.5 * na * (na + 1);
  out.rank_biserial = 2 * out.u / (na * nb) - 1;
  out.ties = ranks.tie_cubes > 0;
  const double smaller = std::min(out.u, na * nb - out.u);
  if (!out.ties && std::max(a.size(), b.size()) <= kLargestExactSample) {
    out.form = RankForm::exact;
    out.z = kNan;
    out.p = two_sided(mann_whitney_counts(a.size(), b.size()), smaller);
    return out;
  }
  const double n = na + nb;
  const double variance = na * nb / 12 * ((n + 1) - ranks.tie_cubes / (n * (n - 1)));
  if (!(variance > 0)) {
    out.z = out.p = kNan;
    return out;
  }
  out.form = RankForm::normal;
  const double away = std::max(0.0, std::abs(out.u - 0.5 * na * nb) - 0.5);
  out.z = std::copysign(away, out.u - 0.5 * na * nb) / std::sqrt(variance);
  out.p = normal_two_sided(out.z);
  return out;
}

Wilcoxon wilcoxon_signed_rank(std::span<const double> differences) {
  std::vector<double> d = numbers(differences), size;
  Wilcoxon out;
  out.zeros = std::erase(d, 0.0);
  out.n = d.size();
  if (d.empty()) {
    out.p = out.z = out.rank_biserial = kNan;
    return out;
  }
  for (const double v : d) size.push_back(std::abs(v));
  const Ranks ranks = mid_ranks(size);
  for (std::size_t i = 0; i < d.size(); ++i) (d[i] > 0 ? out.w_plus : out.w_minus) += ranks.rank[i];
  out.rank_biserial = (out.w_plus - out.w_minus) / (out.w_plus + out.w_minus);
  out.ties = ranks.tie_cubes > 0;
  if (!out.ties && d.size() <= kLargestExactSample) {
    out.form = RankForm::exact;
    out.z = kNan;
    out.p = two_sided(signed_rank_counts(d.size()), std::min(out.w_plus, out.w_minus));
    return out;
  }
  out.form = RankForm::normal;
  const auto n = static_cast<double>(d.size());
  const double variance = (n * (n + 1) * (2 * n + 1) - 0.5 * ranks.tie_cubes) / 24;
  const double mean = 0.25 * n * (n + 1);
  const double away = std::max(0.0, std::abs(out.w_plus - mean) - 0.5);
  out.z = std::copysign(away, out.w_plus - mean) / std::sqrt(variance);
  out.p = normal_two_sided(out.z);
  return out;
}

}  // namespace palpate::study::statistics
