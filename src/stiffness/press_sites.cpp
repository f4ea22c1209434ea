// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/press_sites.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "fem/lanes/batch.hpp"
#include "stiffness/site_features.hpp"

namespace palpate::stiffness {
namespace {

// [-] Domain radius over tool radius: 43 mm for a fingertip. Rim free; twice as wide changes 25 mm
// of tissue by 1 %, half as wide by 6 % (docs/method/sweep.md).
constexpr double kDomainPerTool = 5.4;
constexpr double kThickPerTool = 1.5;  // [-] of the tool's radius: deeper tissue has three layers
constexpr double kFirstLayerShare = 0.31;  // [-] of the tool's radius: thickest top layer

/// One template with what is shared by all threads, and the sites that use it.
struct Kind {
  PatchTemplate tissue;
  fem::lanes::Plan plan;
  std::vector<int> members;  // positions in `sites`, by depth: like sites converge alike

  explicit Kind(const PatchRule& rule)
      : tissue(make_template(rule)), plan(fem::lanes::make_plan(tissue.topology)) {}
  int batches() const {
    return (static_cast<int>(members.size()) + fem::lanes::kLanes - 1) / fem::lanes::kLanes;
  }
};

/// A tool that is pressed harder goes deeper; an equilibrium on another branch is no curve.
bool deepens(std::span<const double> travel) {
  double last = 0;
  for (const double u : travel) {
    if (!(u > last)) return false;
    last = u;
  }
  return !travel.empty();
}

class Presser {
 public:
  Presser(const Ground& ground, std::span<const std::int32_t> sites, std::span<const double> depth)
      : ground_(ground),
        sites_(sites),
        moduli_(fem::lame_moduli(ground.options.youngs_modulus, ground.options.poissons_ratio)),
        tool_{radius(), fem::default_penalty(ground.options.youngs_modulus, radius())},
        kinds_{Kind(rule_for_depth(0, radius())), Kind(rule_for_depth(1e9, radius()))} {
    std::vector<int> order(sites.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return depth[sites[a]] < depth[sites[b]]; });
    for (const int i : order)
      kinds_[depth[sites[i]] > kThickPerTool * radius()].members.push_back(i);
    result_.curves.resize(sites.size());
  }

  PressedSites run(const Progress& progress, double from, double to) {
    const int thin = kinds_[0].batches();
    parallel(thin + kinds_[1].batches(), ground_.options, progress, from, to, [&](int b) {
      if (b < thin)
        press_batch(kinds_[0], b, workspaces_[0].local());
      else
        press_batch(kinds_[1], b - thin, workspaces_[1].local());
    });
    result_.clamped = clamped_;
    result_.in_double = in_double_;
    return std::move(result_);
  }

 private:
  using Workspace = std::unique_ptr<fem::lanes::BatchPress>;

  double radius() const { return ground_.options.tool_radius; }

  void press_batch(const Kind& kind, int batch, Workspace& workspace) {
    if (!workspace)
      workspace = std::make_unique<fem::lanes::BatchPress>(kind.tissue.topology, kind.plan,
                                                           fem::lanes::best_instruction_set());
    const int first = batch * fem::lanes::kLanes;
    const int count = std::min(fem::lanes::kLanes, static_cast<int>(kind.members.size()) - first);
    std::vector<std::vector<Vec3>> patches;
    for (int i = 0; i < count; ++i) {
      const PatchGeometry g = sample_patch(kind.tissue.columns, radius(),
                                           ground_.frames[sites_[kind.members[first + i]]],
                                           ground_.skin, ground_.bone, ground_.limits);
      if (g.bent > 0) ++clamped_;
      patches.push_back(patch_nodes(kind.tissue, g, kFirstLayerShare * radius()));
    }
    const auto lanes =
        workspace->press(patches, moduli_, {tool_.radius, tool_.penalty}, ground_.forces);
    for (int i = 0; i < count; ++i) {
      SiteCurve& curve = result_.curves[kind.members[first + i]];
      curve = {lanes[i].travel, lanes[i].iterations, lanes[i].shifts, 0};
      if (!deepens(curve.travel)) curve = press_in_double(kind, patches[i]);
      if (!deepens(curve.travel)) curve.travel.clear();
    }
  }

  SiteCurve press_in_double(const Kind& kind, const std::vector<Vec3>& nodes) {
    ++in_double_;
    fem::Cholesky cholesky(kind.tissue.topology.pattern);
    return press_site(kind.tissue, nodes, fem::neo_hookean(moduli_), tool_, ground_.forces,
                      cholesky);
  }

  const Ground& ground_;
  std::span<const std::int32_t> sites_;
  fem::LameModuli moduli_;
  Tool tool_;
  std::array<Kind, 2> kinds_;
  std::array<tbb::enumerable_thread_specific<Workspace>, 2> workspaces_;
  PressedSites result_;
  std::atomic<int> clamped_ = 0, in_double_ = 0;
};

}  // namespace

Ground::Ground(const HeadSurface& h, const SkullFit& skull, const SweepOptions& o)
    : head(h), options(o), skin(h.skin), bone(skull.mesh) {
  limits.no_bone_beyond = o.no_bone_beyond;
  const std::vector<Vec3> normals = smoothed_normals(h.skin, o.tool_radius);
  for (std::size_t p = 0; p < normals.size(); ++p)
    frames.push_back(site_frame(h.skin.points[p], normals[p]));
  for (int i = 1; i <= o.loads; ++i) forces.push_back(o.max_force * i / o.loads);
}

PatchRule rule_for_depth(double depth, double tool_radius) {
  const int layers = depth > kThickPerTool * tool_radius ? 3 : 2;
  PatchRule rule = default_rule(tool_radius, kDomainPerTool * tool_radius, layers);
  rule.hold_rim = false;
  return rule;
}

PressedSites press_sites(const Ground& ground, std::span<const std::int32_t> sites,
                         std::span<const double> depth, const Progress& progress, double from,
                         double to) {
  return Presser(ground, sites, depth).run(progress, from, to);
}

}  // namespace palpate::stiffness
