// SPDX-License-Identifier: GPL-3.0-or-later
// E. J. Williams: Experimental designs balanced for the estimation of residual effects of
// treatments. Australian Journal of Scientific Research A 2 (1949).
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "study/random.hpp"
#include "study/run.hpp"

namespace palpate::study {

// The first row goes 0, 1, n-1, 2, n-2, ...: its differences between neighbours are all different
// modulo n. The others add 1 to each place. For odd n the differences d and n-d fall together, and
// the same rows read backwards make up for it.
std::vector<std::vector<int>> balanced_rows(int n) {
  std::vector<int> first{0};
  for (int i = 1; i < n; ++i) first.push_back(i % 2 == 1 ? (i + 1) / 2 : n - i / 2);
  std::vector<std::vector<int>> rows;
  for (int shift = 0; shift < n; ++shift) {
    std::vector<int> row;
    for (const int x : first) row.push_back((x + shift) % n);
    rows.push_back(row);
  }
  if (n % 2 == 0 || n == 1) return rows;
  for (int shift = 0; shift < n; ++shift) {
    std::vector<int> row = rows[static_cast<std::size_t>(shift)];
    std::reverse(row.begin(), row.end());
    rows.push_back(row);
  }
  return rows;
}

int rounds_of(const Part& part) {
  switch (part.kind) {
    case PartKind::tutorial:
      return static_cast<int>(part.orders.size());
    case PartKind::experiment:
    case PartKind::discrimination:
      return 1;
    case PartKind::consent:
    case PartKind::questions:
      break;
  }
  return 0;
}

namespace {

// Each block of participants gets every row once, in an order of its own; which region is which
// number is drawn once for the study.
std::vector<std::string> balanced(std::vector<std::string> regions, const std::string& part,
                                  std::uint64_t seed, int order_index) {
  Random names(seed, "names/" + part);
  names.shuffle(regions);
  auto rows = balanced_rows(static_cast<int>(regions.size()));
  const auto index = static_cast<std::size_t>(order_index);
  Random block(seed, "block/" + part, index / rows.size());
  block.shuffle(rows);
  std::vector<std::string> order;
  for (const int x : rows[index % rows.size()])
    order.push_back(regions[static_cast<std::size_t>(x)]);
  return order;
}

std::vector<std::string> by_stiffness(std::vector<std::string> names,
                                      std::span<const StudyRegion> regions) {
  const auto stiffness = [&](const std::string& name) {
    for (const StudyRegion& r : regions)
      if (r.name == name) return r.stiffness;
    return 0.0;
  };
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return stiffness(a) > stiffness(b);
  });
  return names;
}

std::vector<std::string> drawn(OrderKind kind, const Part& part, int round,
                               std::span<const StudyRegion> regions, std::uint64_t seed,
                               int order_index) {
  const std::string label = fmt::format("{}/{}", part.id, round);
  switch (kind) {
    case OrderKind::balanced:
      return balanced(part.regions, label, seed, order_index);
    case OrderKind::stiffness:
      return by_stiffness(part.regions, regions);
    case OrderKind::random:
      break;
  }
  std::vector<std::string> order = part.regions;
  Random(seed, "order/" + label, static_cast<std::uint64_t>(order_index)).shuffle(order);
  return order;
}

}  // namespace

std::vector<PlannedOrder> draw_orders(const Protocol& protocol,
                                      std::span<const StudyRegion> regions, std::uint64_t seed,
                                      int order_index) {
  std::vector<PlannedOrder> all;
  for (const Part& part : protocol.parts)
    for (int round = 1; round <= rounds_of(part); ++round)
      all.push_back({part.id, round,
                     drawn(part.orders[static_cast<std::size_t>(round - 1)], part, round, regions,
                           seed, order_index)});
  return all;
}

}  // namespace palpate::study
