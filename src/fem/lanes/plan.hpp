// SPDX-License-Identifier: GPL-3.0-or-later
// The symbolic half of a batch: elimination order, panels of the factor, where each element adds.
#pragma once
#include <vector>

#include "fem/lanes/plan_view.hpp"
#include "fem/topology.hpp"

namespace palpate::fem::lanes {

/// Made once per topology, read by all threads.
struct Plan {
  int unknowns = 0;
  std::int64_t factor_entries = 0;
  double factor_flops = 0;         ///< multiplications and additions per lane
  double contact_flops = 0;        ///< those of them in the panels of the contact
  std::vector<std::int32_t> slot;  ///< per mesh node: its first unknown; held nodes: `unknowns`
  std::vector<Panel> panels;
  std::vector<Update> updates;
  std::vector<std::int32_t> row_index, position;
  std::vector<std::int32_t> tet_slot, face_slot;
  std::vector<BlockTarget> tet_block, face_block, face_travel;
  std::int64_t travel_entry = 0;
  std::int32_t contact_panel = 0;
  std::vector<float> face_shape, face_weight;

  [[nodiscard]] PlanView view() const;
  /// Where the contact's panels start in the factor; they go to its end.
  [[nodiscard]] std::int64_t contact_start() const { return panels[contact_panel].offset; }
};
/// Nested dissection of the node graph (METIS), the nodes of the contact faces after all others and
/// the travel last; small supernodes are merged. The panels of the contact can so be factorised
/// again, with another contact, while the rest of the factor stands.
/// @param topology  quadratic, with travel
[[nodiscard]] Plan make_plan(const Topology& topology);

}  // namespace palpate::fem::lanes
