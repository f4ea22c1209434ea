// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/lanes/plan.hpp"

#include <algorithm>
#include <cassert>

#include "core/error.hpp"
#include "fem/lanes/symbolic.hpp"

namespace palpate::fem::lanes {
namespace {

constexpr int kMostRows = 4096;  // of a panel; as in kernels_factor.inc
// Nodes per panel: nine rows of 48 columns and 16 lanes are 27 KiB and stay in the first cache.
constexpr int kMostNodes = 16;

Graph node_graph(const Topology& t) {
  Graph graph(t.free_nodes);
  const int stride = tet_nodes(t.order);
  for (std::size_t first = 0; first < t.tets.size(); first += stride)
    for (int i = 0; i < stride; ++i)
      for (int j = 0; j < stride; ++j) {
        const int a = t.free_node[t.tets[first + i]], b = t.free_node[t.tets[first + j]];
        if (a >= 0 && b >= 0 && a != b) graph[a].push_back(b);
      }
  for (auto& list : graph) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return graph;
}

/// The travel couples with the nodes of the contact faces only; it has a row in their panels.
/// @param first_contact  the first node in elimination order that lies on a contact face
void make_panels(const Elimination& elimination, std::int32_t first_contact, Plan& plan) {
  for (const Supernode& s : elimination.supernodes) {
    const bool contact = s.first >= first_contact;
    const int pieces = (s.count + kMostNodes - 1) / kMostNodes;
    for (int piece = 0; piece < pieces; ++piece) {
      const int from = s.count * piece / pieces, to = s.count * (piece + 1) / pieces;
      Panel p{};
      p.first = 3 * (s.first + from);
      p.width = 3 * (to - from);
      p.row_index = static_cast<std::int32_t>(plan.row_index.size());
      for (int i = 3 * from; i < 3 * s.count; ++i) plan.row_index.push_back(3 * s.first + i);
      for (const std::int32_t node : s.below)
        for (int i = 0; i < 3; ++i) plan.row_index.push_back(3 * node + i);
      if (contact) plan.row_index.push_back(plan.unknowns - 1);
      p.rows = static_cast<std::int32_t>(plan.row_index.size()) - p.row_index;
      p.offset = plan.factor_entries;
      plan.factor_entries += static_cast<std::int64_t>(p.rows) * p.width;
      plan.panels.push_back(p);
      if (!contact) plan.contact_panel = static_cast<std::int32_t>(plan.panels.size());
    }
  }
  Panel travel{};
  travel.first = plan.unknowns - 1;
  travel.width = travel.rows = 1;
  travel.row_index = static_cast<std::int32_t>(plan.row_index.size());
  plan.row_index.push_back(travel.first);
  travel.offset = plan.travel_entry = plan.factor_entries++;
  plan.panels.push_back(travel);
}

/// Row of `panel` that stands for `unknown`.
std::int32_t row_of(const Plan& plan, const Panel& panel, std::int32_t unknown) {
  const auto from = plan.row_index.begin() + panel.row_index, to = from + panel.rows;
  const auto at = std::lower_bound(from, to, unknown);
  assert(at != to && *at == unknown);
  return static_cast<std::int32_t>(at - from);
}

void make_updates(Plan& plan) {
  std::vector<std::vector<Update>> of(plan.panels.size());
  std::vector<std::int32_t> panel_of(plan.unknowns);
  for (std::size_t p = 0; p < plan.panels.size(); ++p)
    for (int i = 0; i < plan.panels[p].width; ++i)
      panel_of[plan.panels[p].first + i] = static_cast<std::int32_t>(p);
  for (std::size_t k = 0; k < plan.panels.size(); ++k) {
    const Panel& source = plan.panels[k];
    const std::int32_t* rows = &plan.row_index[source.row_index];
    const double w = source.width;
    const double flops =
        w * w * (source.rows - 2 * w / 3) + w * (source.rows - w) * (source.rows - w + 1);
    plan.factor_flops += flops;
    if (static_cast<std::int32_t>(k) >= plan.contact_panel) plan.contact_flops += flops;
    for (std::int32_t from = source.width; from < source.rows;) {
      const std::int32_t target = panel_of[rows[from]];
      Update u{static_cast<std::int32_t>(k), from, 0,
               static_cast<std::int32_t>(plan.position.size())};
      while (from + u.columns < source.rows && panel_of[rows[from + u.columns]] == target)
        ++u.columns;
      for (std::int32_t i = from; i < source.rows; ++i)
        plan.position.push_back(row_of(plan, plan.panels[target], rows[i]));
      of[target].push_back(u);
      from += u.columns;
    }
  }
  for (std::size_t p = 0; p < plan.panels.size(); ++p) {
    plan.panels[p].first_update = static_cast<std::int32_t>(plan.updates.size());
    plan.panels[p].updates = static_cast<std::int32_t>(of[p].size());
    plan.updates.insert(plan.updates.end(), of[p].begin(), of[p].end());
  }
}

class Targets {
 public:
  explicit Targets(const Plan& plan) : plan_(plan), panel_of_(plan.unknowns) {
    for (std::size_t p = 0; p < plan.panels.size(); ++p)
      for (int i = 0; i < plan.panels[p].width; ++i)
        panel_of_[plan.panels[p].first + i] = static_cast<std::int32_t>(p);
  }
  /// Block whose rows start at unknown a and whose columns start at unknown b.
  BlockTarget block(std::int32_t a, std::int32_t b) const {
    if (a >= plan_.unknowns || b >= plan_.unknowns) return {-1, 0, 0};
    const bool transposed = a < b;
    if (transposed) std::swap(a, b);
    const Panel& p = plan_.panels[panel_of_[b]];
    const std::int64_t row = row_of(plan_, p, a);
    return {p.offset + row * p.width + (b - p.first), p.width, transposed};
  }

 private:
  const Plan& plan_;
  std::vector<std::int32_t> panel_of_;
};

void make_targets(const Topology& t, Plan& plan) {
  const Targets targets(plan);
  const std::int32_t travel = plan.unknowns - 1;
  for (const std::int32_t node : t.tets) plan.tet_slot.push_back(plan.slot[node]);
  for (std::size_t first = 0; first < t.tets.size(); first += kTetNodes)
    for (int a = 0; a < kTetNodes; ++a)
      for (int b = 0; b <= a; ++b)
        plan.tet_block.push_back(targets.block(plan.tet_slot[first + a], plan.tet_slot[first + b]));
  for (const std::int32_t node : t.contact_faces) plan.face_slot.push_back(plan.slot[node]);
  for (std::size_t first = 0; first < t.contact_faces.size(); first += kFaceNodes)
    for (int a = 0; a < kFaceNodes; ++a) {
      const std::int32_t slot = plan.face_slot[first + a];
      plan.face_travel.push_back(slot < plan.unknowns ? targets.block(travel, slot)
                                                      : BlockTarget{-1, 0, 0});
      for (int b = 0; b <= a; ++b)
        plan.face_block.push_back(targets.block(slot, plan.face_slot[first + b]));
    }
}

}  // namespace

Plan make_plan(const Topology& t) {
  if (t.order != ElementOrder::quadratic || !t.has_travel)
    throw InputError("a batch needs quadratic elements and contact faces");
  Plan plan;
  plan.unknowns = t.unknowns();
  std::vector<std::uint8_t> on_contact(t.free_nodes, 0);
  for (const std::int32_t node : t.contact_faces)
    if (t.free_node[node] >= 0) on_contact[t.free_node[node]] = 1;
  const auto contact_nodes =
      static_cast<std::int32_t>(std::count(on_contact.begin(), on_contact.end(), 1));
  const Elimination elimination = eliminate(node_graph(t), on_contact);
  std::vector<std::int32_t> rank(t.free_nodes);
  for (int k = 0; k < t.free_nodes; ++k) rank[elimination.order[k]] = k;
  for (const std::int32_t f : t.free_node) plan.slot.push_back(f < 0 ? plan.unknowns : 3 * rank[f]);
  make_panels(elimination, t.free_nodes - contact_nodes, plan);
  for (const Panel& p : plan.panels)
    if (p.rows > kMostRows) throw InputError("the patch is too fine for the batch solver");
  make_updates(plan);
  make_targets(t, plan);
  for (std::size_t q = 0; q < contact_quadrature().weights.size(); ++q) {
    const Eigen::VectorXd shape = face_shape(t.order, contact_quadrature().points[q]);
    plan.face_shape.insert(plan.face_shape.end(), shape.begin(), shape.end());
    plan.face_weight.push_back(static_cast<float>(contact_quadrature().weights[q]));
  }
  return plan;
}

PlanView Plan::view() const {
  PlanView v{};
  v.unknowns = unknowns;
  v.factor_entries = factor_entries;
  v.panels = panels.data();
  v.contact_panel = contact_panel;
  v.panel_count = static_cast<std::int32_t>(panels.size());
  v.updates = updates.data();
  v.row_index = row_index.data();
  v.position = position.data();
  v.tets = static_cast<std::int32_t>(tet_slot.size()) / kTetNodes;
  v.tet_slot = tet_slot.data();
  v.tet_block = tet_block.data();
  v.faces = static_cast<std::int32_t>(face_slot.size()) / kFaceNodes;
  v.face_slot = face_slot.data();
  v.face_block = face_block.data();
  v.face_travel = face_travel.data();
  v.travel_entry = travel_entry;
  v.face_points = static_cast<std::int32_t>(face_weight.size());
  v.face_shape = face_shape.data();
  v.face_weight = face_weight.data();
  return v;
}

}  // namespace palpate::fem::lanes
