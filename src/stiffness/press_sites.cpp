// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/press_sites.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fem/lanes/batch.hpp"

namespace palpate::stiffness {
namespace {

// [-] Domain radius over tool radius: 43 mm for a fingertip. Rim free; twice as wide changes 25 mm
// of tissue by 1 %, half as wide by 6 % (docs/method/sweep.md).
constexpr double kDomainPerTool = 5.4;

/// What a depth asks for; lengths as shares of the tool's radius. Each kind is within 2 % of
/// refined patches over its depths, and cheaper than the next by a third and by two thirds
/// (docs/method/sweep.md).
struct DepthKind {
  double deepest;      // up to here
  int layers;          // of elements
  double first_layer;  // thickest one under the skin
  int rings_less;      // thin tissue feels the tool less far
};
constexpr std::array<DepthKind, 3> kDepthKinds = {
    {{1, 2, 0.31, 1}, {2, 2, 0.5, 0}, {1e9, 3, 0.31, 0}}};

std::size_t kind_of(double depth, double tool_radius) {
  std::size_t kind = 0;
  while (kind + 1 < kDepthKinds.size() && depth > kDepthKinds[kind].deepest * tool_radius) ++kind;
  return kind;
}

PatchRule rule_of(const DepthKind& kind, double tool_radius) {
  PatchRule rule = default_rule(tool_radius, kDomainPerTool * tool_radius, kind.layers);
  rule.rings.resize(rule.rings.size() - kind.rings_less);
  rule.first_layer = kind.first_layer * tool_radius;
  rule.hold_rim = false;
  return rule;
}

/// A few wide rings on one element layer: a tenth of the default patch's work. Its travel is some
/// per cent off, but off alike at like places (docs/method/sweep.md).
PatchRule coarse_rule(double tool_radius) {
  PatchRule rule;
  rule.rings = {{0.3125 * tool_radius, 6}, {0.6875 * tool_radius, 8},
                {1.125 * tool_radius, 8},  {2.0 * tool_radius, 8},
                {3.5 * tool_radius, 6},    {kDomainPerTool * tool_radius, 6}};
  rule.layers = 1;
  rule.touch_radius = 1.6 * tool_radius;
  rule.hold_rim = false;
  return rule;
}

/// One template with what is shared by all threads.
struct Kind {
  PatchTemplate tissue;
  fem::lanes::Plan plan;
  std::vector<double> levels;
  std::vector<std::vector<std::int32_t>> rings;
  std::vector<std::int32_t> members;  // sites to solve, by depth: like sites converge alike
  std::vector<double> forces;

  explicit Kind(const PatchRule& rule)
      : tissue(make_template(rule)), plan(fem::lanes::make_plan(tissue.topology)) {}
  int batches() const {
    return (static_cast<int>(members.size()) + fem::lanes::kLanes - 1) / fem::lanes::kLanes;
  }
};

class Presser {
 public:
  Presser(const Ground& ground, SolveLevel level, Checkpoint& store)
      : ground_(ground),
        level_(level),
        store_(store),
        batched_(ground.flesh.neo_hookean_only()),
        kinds_{make_kind(0), make_kind(1), make_kind(2)} {}

  void run(std::span<const std::int32_t> sites, const Shard& shard, const Progress& progress,
           double from, double to) {
    std::vector<std::int32_t> order(sites.begin(), sites.end());
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
      return ground_.spots[a].depth < ground_.spots[b].depth;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (static_cast<int>(i / fem::lanes::kLanes % shard.count) != shard.index) continue;
      if (!store_.find(level_, order[i]))
        kinds_[kind_of(ground_.spots[order[i]].depth, radius())].members.push_back(order[i]);
    }
    std::vector<std::pair<std::size_t, int>> batches;  // kind, number
    for (std::size_t k = 0; k < kinds_.size(); ++k)
      for (int b = 0; b < kinds_[k].batches(); ++b) batches.emplace_back(k, b);
    parallel(static_cast<int>(batches.size()), ground_.options, progress, from, to, [&](int i) {
      const auto [k, b] = batches[i];
      press_batch(kinds_[k], b, workspaces_[k].local());
    });
  }

 private:
  using Workspace = std::unique_ptr<fem::lanes::BatchPress>;

  double radius() const { return ground_.options.tool_radius; }

  Kind make_kind(std::size_t depth_kind) const {
    PatchRule rule = rule_of(kDepthKinds[depth_kind], radius());
    rule.layers = ground_.flesh.element_layers(rule.layers);
    if (level_ == SolveLevel::coarse) {
      rule = coarse_rule(radius());
      if (ground_.options.tissue.kind == TissueKind::layered)
        rule.layers = ground_.flesh.element_layers(2);
    }
    Kind kind(rule);
    kind.levels = ground_.flesh.levels(rule.layers);
    kind.forces = ground_.forces;
    if (level_ == SolveLevel::coarse) kind.forces = coarse_forces(ground_.forces);
    if (level_ == SolveLevel::full) kind.rings = skin_rings(kind.tissue);
    return kind;
  }

  void press_batch(const Kind& kind, int batch, Workspace& workspace) {
    const int first = batch * fem::lanes::kLanes;
    const int count = std::min(fem::lanes::kLanes, static_cast<int>(kind.members.size()) - first);
    const auto sites = std::span(kind.members).subspan(first, count);
    std::vector<fem::lanes::BatchPatch> patches;
    std::vector<PatchGeometry> geometry;
    for (const std::int32_t site : sites) {
      const PatchGeometry g = sample_patch(kind.tissue.columns, radius(), ground_.spots[site].frame,
                                           ground_.skin, ground_.carriers.query(), ground_.limits);
      patches.push_back({patch_nodes(kind.tissue, g, kind.tissue.rule.first_layer, kind.levels),
                         ground_.flesh.moduli(kind.tissue, g),
                         fem::default_penalty(ground_.flesh.surface_modulus(g), radius())});
      geometry.push_back(g);
    }
    std::vector<SiteCurve> curves(count);
    if (batched_) curves = press_lanes(kind, patches, workspace);
    for (int i = 0; i < count; ++i)
      if (!deepens(curves[i].travel)) curves[i] = press_in_double(kind, patches[i], geometry[i]);
    for (int i = 0; i < count; ++i) {
      curves[i].bent = geometry[i].bent > 0;
      if (level_ == SolveLevel::full) widen(curves[i].sunk, kind.rings.size());
    }
    store_.put(level_, sites, curves);
  }

  std::vector<SiteCurve> press_lanes(const Kind& kind,
                                     std::span<const fem::lanes::BatchPatch> patches,
                                     Workspace& workspace) const {
    if (!workspace)
      workspace = std::make_unique<fem::lanes::BatchPress>(kind.tissue.topology, kind.plan,
                                                           fem::lanes::best_instruction_set());
    std::vector<SiteCurve> curves;
    for (fem::lanes::LaneCurve& lane : workspace->press(patches, radius(), kind.forces, kind.rings))
      curves.push_back({std::move(lane.travel),
                        std::move(lane.sunk),
                        SolveMethod::batch,
                        false,
                        lane.iterations,
                        lane.shifts,
                        0,
                        {}});
    return curves;
  }

  /// Beyond the domain nothing sinks: zeros for the rings that a small template lacks.
  void widen(std::vector<double>& sunk, std::size_t rings) const {
    const std::size_t all = dent_radii(radius()).size(), loads = sunk.size() / rings;
    std::vector<double> out;
    for (std::size_t i = 0; i < loads; ++i) {
      out.insert(out.end(), sunk.begin() + i * rings, sunk.begin() + (i + 1) * rings);
      out.resize((i + 1) * all, 0.0);
    }
    sunk = std::move(out);
  }

  SiteCurve press_in_double(const Kind& kind, const fem::lanes::BatchPatch& patch,
                            const PatchGeometry& geometry) const {
    fem::Cholesky cholesky(kind.tissue.topology.pattern);
    return press_site(kind.tissue, patch.nodes, ground_.flesh.laws(kind.tissue, geometry),
                      {radius(), patch.penalty}, kind.forces, cholesky);
  }

  const Ground& ground_;
  SolveLevel level_;
  Checkpoint& store_;
  bool batched_;
  std::array<Kind, 3> kinds_;
  std::array<tbb::enumerable_thread_specific<Workspace>, 3> workspaces_;
};

}  // namespace

PatchRule rule_for_depth(double depth, double tool_radius) {
  return rule_of(kDepthKinds[kind_of(depth, tool_radius)], tool_radius);
}

std::vector<double> dent_radii(double tool_radius) {
  std::vector<double> radii = {0};
  for (const Ring& r : rule_of(kDepthKinds.back(), tool_radius).rings) radii.push_back(r.radius);
  return radii;
}

std::vector<double> coarse_forces(std::span<const double> forces) {
  std::vector<double> out;
  for (const double share : {0.0, 0.4, 1.0}) {
    const auto at = static_cast<std::size_t>(
        std::max(std::ceil(share * static_cast<double>(forces.size())) - 1, 0.0));
    if (out.empty() || forces[at] > out.back()) out.push_back(forces[at]);
  }
  return out;
}

void press_sites(const Ground& ground, SolveLevel level, std::span<const std::int32_t> sites,
                 const Shard& shard, Checkpoint& store, const Progress& progress, double from,
                 double to) {
  if (!sites.empty()) Presser(ground, level, store).run(sites, shard, progress, from, to);
}

}  // namespace palpate::stiffness
