// SPDX-License-Identifier: GPL-3.0-or-later
// Elimination of a node graph without numbers.
#pragma once
#include <cstdint>
#include <vector>

namespace palpate::fem::lanes {

/// neighbours[i]: nodes that share an element with i, without i.
using Graph = std::vector<std::vector<std::int32_t>>;

/// A run of nodes [first, first + count) in elimination order that share their rows below.
struct Supernode {
  std::int32_t first = 0, count = 0;
  std::vector<std::int32_t> below;  ///< later nodes, ascending
};
struct Elimination {
  std::vector<std::int32_t> order;  ///< order[k]: node that is eliminated k-th
  std::vector<Supernode> supernodes;
};
/// Nested dissection, postordered; chains of parents and children are merged as long as few zeros
/// come in.
/// @param last  one per node: non-zero for those that are eliminated after all others, in
///              supernodes of their own
[[nodiscard]] Elimination eliminate(const Graph& graph, const std::vector<std::uint8_t>& last);

}  // namespace palpate::fem::lanes
