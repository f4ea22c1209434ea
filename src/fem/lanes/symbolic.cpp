// SPDX-License-Identifier: GPL-3.0-or-later
// Davis 2006, "Direct Methods for Sparse Linear Systems", chapter 4; the rule for merging is that
// of CHOLMOD (Chen et al. 2008, section 3.2), with limits in nodes of three unknowns.
#include "fem/lanes/symbolic.hpp"

#include <cholmod.h>

#include <algorithm>

#include "core/error.hpp"

namespace palpate::fem::lanes {
namespace {

std::vector<std::int32_t> nested_dissection(const Graph& graph) {
  cholmod_common common;
  cholmod_start(&common);
  const std::size_t n = graph.size();
  std::size_t entries = 0;
  for (const auto& list : graph) entries += list.size();
  cholmod_sparse* a = cholmod_allocate_sparse(n, n, entries, 1, 1, 1, CHOLMOD_PATTERN, &common);
  auto* start = static_cast<int*>(a->p);
  auto* row = static_cast<int*>(a->i);
  int at = 0;
  for (std::size_t c = 0; c < n; ++c) {
    start[c] = at;
    for (const std::int32_t r : graph[c])
      if (r < static_cast<std::int32_t>(c)) row[at++] = r;
  }
  start[n] = at;
  std::vector<std::int32_t> order(n);
  const bool done = cholmod_metis(a, nullptr, 0, 1, order.data(), &common);
  cholmod_free_sparse(&a, &common);
  cholmod_finish(&common);
  if (!done) throw SolveError("the patch's graph could not be ordered");
  return order;
}

/// Nested dissection of the nodes that are not last, then those.
std::vector<std::int32_t> order_with_last(const Graph& graph,
                                          const std::vector<std::uint8_t>& last) {
  const auto n = static_cast<std::int32_t>(graph.size());
  std::vector<std::int32_t> number(n, -1), first;
  for (std::int32_t i = 0; i < n; ++i)
    if (!last[i]) {
      number[i] = static_cast<std::int32_t>(first.size());
      first.push_back(i);
    }
  Graph inner(first.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    for (const std::int32_t neighbour : graph[first[i]])
      if (number[neighbour] >= 0) inner[i].push_back(number[neighbour]);
  std::vector<std::int32_t> order;
  for (const std::int32_t i : nested_dissection(inner)) order.push_back(first[i]);
  for (std::int32_t i = 0; i < n; ++i)
    if (last[i]) order.push_back(i);
  return order;
}

/// Later neighbours of each node in elimination order, fill included.
std::vector<std::vector<std::int32_t>> column_structures(const Graph& graph,
                                                         const std::vector<std::int32_t>& order) {
  const auto n = static_cast<std::int32_t>(graph.size());
  std::vector<std::int32_t> rank(n);
  for (std::int32_t k = 0; k < n; ++k) rank[order[k]] = k;
  std::vector<std::vector<std::int32_t>> below(n), children(n);
  for (std::int32_t k = 0; k < n; ++k) {
    std::vector<std::int32_t>& s = below[k];
    for (const std::int32_t neighbour : graph[order[k]])
      if (rank[neighbour] > k) s.push_back(rank[neighbour]);
    for (const std::int32_t c : children[k])
      s.insert(s.end(), below[c].begin() + 1, below[c].end());  // the first is k itself
    std::sort(s.begin(), s.end());
    s.erase(std::unique(s.begin(), s.end()), s.end());
    if (!s.empty()) children[s.front()].push_back(k);
  }
  return below;
}

/// Whether a supernode of `count` nodes that would hold the share `zeros` of zeros is worth having.
bool worth_merging(int count, double zeros) {
  if (count <= 4) return true;
  if (count <= 8) return zeros < 0.6;
  if (count <= 16) return zeros < 0.15;
  return zeros < 0.05;
}

double entries(double count, double below) {
  return count * (count + 1) / 2 + count * below;
}

}  // namespace

Elimination eliminate(const Graph& graph, const std::vector<std::uint8_t>& last) {
  Elimination out{order_with_last(graph, last), {}};
  const auto below = column_structures(graph, out.order);
  std::vector<double> nonzeros;  // true entries in each supernode
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(below.size()); ++k) {
    out.supernodes.push_back({k, 1, below[k]});
    nonzeros.push_back(1 + static_cast<double>(below[k].size()));
    // Merge upwards while the last supernode is the parent of the one before it.
    while (out.supernodes.size() > 1) {
      Supernode& parent = out.supernodes.back();
      Supernode& child = out.supernodes[out.supernodes.size() - 2];
      if (child.below.empty() || child.below.front() != parent.first ||
          child.first + child.count != parent.first ||
          last[out.order[child.first]] != last[out.order[parent.first]])
        break;
      const int count = child.count + parent.count;
      const double full = entries(count, static_cast<double>(parent.below.size()));
      const double kept = nonzeros.back() + nonzeros[nonzeros.size() - 2];
      if (!worth_merging(count, 1 - kept / full)) break;
      child.count = count;
      child.below = std::move(parent.below);
      out.supernodes.pop_back();
      nonzeros.pop_back();
      nonzeros.back() = kept;
    }
  }
  return out;
}

}  // namespace palpate::fem::lanes
