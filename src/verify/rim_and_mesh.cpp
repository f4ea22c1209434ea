// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the answer is the mesh: element kind and size, where the domain ends and how, and the
// patch that the product uses by default.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "fem/press.hpp"
#include "stiffness/press_sites.hpp"
#include "verify/blocks.hpp"
#include "verify/slab.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;

constexpr double kToolRadius = 8;  // [mm] a fingertip
const std::vector<double> kForces = {0.5, 1.5, 5};

/// Travel of the tool at the forces; NaN where no equilibrium was found.
std::vector<double> travel_on(const Slab& slab) {
  const Topology t = make_topology(slab.mesh, slab.held, slab.touchable);
  Indenter tool;
  tool.radius = kToolRadius;
  tool.start = Vec3(0, 0, kToolRadius);
  tool.penalty = default_penalty(kFleshModulus, kToolRadius);
  const ElasticBody body(t, slab.mesh.nodes, neo_hookean(flesh_moduli()));
  const Contact contact(t, slab.mesh.nodes, tool);
  Cholesky cholesky(t.pattern);
  std::vector<double> travel = press(body, contact, kForces, cholesky).travel;
  travel.resize(kForces.size(), std::numeric_limits<double>::quiet_NaN());
  return travel;
}

/// Even rings of `size` under the tool, then a progression out to `rim`.
SlabRule even_rule(double thickness, double size, double rim) {
  SlabRule rule;
  constexpr double kUnderTool = 12;  // [mm] beyond the contact radius at 5 N
  constexpr double kGirth = 38;      // [mm] of the circle where sectors are as wide as rings
  rule.sectors = std::max(8, static_cast<int>(std::lround(kGirth / size)));
  for (int r = 1; r * size < kUnderTool + size; ++r) rule.rings.push_back(r * size);
  while (rule.rings.back() < rim * 0.8)
    rule.rings.push_back(std::min(rim, 1.45 * rule.rings.back()));
  rule.rings.back() = rim;
  const int layers = std::max(2, static_cast<int>(std::lround(thickness / size)));
  for (int l = 0; l <= layers; ++l) rule.depths.push_back(thickness * l / layers);
  rule.touch_radius = kUnderTool + 1.01 * size;
  return rule;
}

void study_mesh(const VerifyOptions& options, Section& s) {
  report::Page::Table table{{"element", "size [mm]", "u(0.5 N) [mm]", "u(5 N) [mm]"}, {}};
  plot::LinePlot plot{"Travel at 5 N on 8 mm of flesh", "element size [mm]", "travel [mm]"};
  plot.include_zero = false;
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const bool quadratic = order == ElementOrder::quadratic;
    plot::Series series{quadratic ? "10 nodes" : "4 nodes", {}, {}};
    std::vector<double> sizes = quadratic ? std::vector{4.0, 3.0, 2.0} : std::vector{4.0, 2.5, 1.5};
    if (options.quick) sizes.pop_back();
    for (const double size : sizes) {
      const std::vector<double> u = travel_on(make_slab(even_rule(8, size, 43), order));
      table.rows.push_back({series.name, fmt::format("{}", size), fmt::format("{:.3f}", u[0]),
                            fmt::format("{:.3f}", u[2])});
      series.x.push_back(size);
      series.y.push_back(u[2]);
    }
    plot.series.push_back(series);
  }
  s.tables.push_back(table);
  s.plots.push_back(plot);
}

void study_rim(const VerifyOptions& options, Section& s) {
  report::Page::Table table{{"domain radius [mm]", "rim held, u(5 N) [mm]", "rim free [mm]"}, {}};
  plot::LinePlot plot{"Where the domain ends: travel at 5 N on 15 mm of flesh", "radius [mm]",
                      "travel [mm]"};
  plot.include_zero = false;
  plot.series = {{"rim held", {}, {}}, {"rim free", {}, {}}};
  for (const double rim :
       options.quick ? std::vector{22.0, 43.0} : std::vector{22.0, 30.0, 43.0, 60.0}) {
    double u[2];
    for (const bool held : {true, false}) {
      SlabRule rule = even_rule(15, 4, rim);
      rule.hold_rim = held;
      u[held ? 0 : 1] = travel_on(make_slab(rule, ElementOrder::quadratic))[2];
    }
    table.rows.push_back(
        {fmt::format("{}", rim), fmt::format("{:.3f}", u[0]), fmt::format("{:.3f}", u[1])});
    for (int i = 0; i < 2; ++i) {
      plot.series[i].x.push_back(rim);
      plot.series[i].y.push_back(u[i]);
    }
  }
  s.tables.push_back(table);
  s.plots.push_back(plot);
}

/// Travel on a slab with the patch that the sweep uses there.
std::vector<double> default_travel(double thickness) {
  const stiffness::PatchTemplate t =
      stiffness::make_template(stiffness::rule_for_depth(thickness, kToolRadius));
  stiffness::PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), thickness);
  constexpr double kFirstLayer = 0.31;  // [tool radii] as the sweep's
  Cholesky cholesky(t.topology.pattern);
  return stiffness::press_site(t, stiffness::patch_nodes(t, g, kFirstLayer * kToolRadius),
                               neo_hookean(flesh_moduli()),
                               {kToolRadius, default_penalty(kFleshModulus, kToolRadius)}, kForces,
                               cholesky)
      .travel;
}

/// Fine rings, four layers, rim held at 85 mm.
std::vector<double> fine_travel(double thickness) {
  SlabRule rule;
  rule.rings = {1.5, 3, 4.5, 6, 8, 10, 13, 17, 22, 31, 43, 60, 85};
  rule.sectors = 18;
  rule.depths = graded_depths(thickness, std::min(2.0, thickness / 4), 1.35);
  rule.touch_radius = 14;
  rule.hold_rim = true;
  return travel_on(make_slab(rule, ElementOrder::quadratic));
}

void check_default_patch(const VerifyOptions& options, Section& s) {
  report::Page::Table table{
      {"thickness [mm]", "force [N]", "default [mm]", "refined [mm]", "error"}, {}};
  double light = 0, heavy = 0;
  for (const double thickness : options.quick ? std::vector{8.0} : std::vector{3.0, 8.0, 15.0}) {
    const std::vector<double> u = default_travel(thickness), fine = fine_travel(thickness);
    for (const std::size_t i : {0u, 2u}) {
      const double error =
          u.size() > i ? std::abs(u[i] / fine[i] - 1) : std::numeric_limits<double>::quiet_NaN();
      table.rows.push_back({fmt::format("{}", thickness), fmt::format("{}", kForces[i]),
                            u.size() > i ? fmt::format("{:.4f}", u[i]) : "failed",
                            fmt::format("{:.4f}", fine[i]), fmt::format("{:.2f} %", 100 * error)});
      double& worst = i == 0 ? light : heavy;
      worst = std::isnan(error) ? error : std::max(worst, error);
    }
  }
  s.figures.push_back(at_most("discretisation of the default patch at 5 N", heavy, 0.02));
  s.figures.push_back(at_most("discretisation of the default patch at 0.5 N", light, 0.05));
  s.tables.push_back(table);
}

}  // namespace

Section study_rim_and_mesh(const VerifyOptions& options) {
  Section s{
      "mesh", "Mesh and rim",
      "A sphere of 8 mm on bonded slabs of flesh, neo-Hookean. First the default patch of the "
      "sweep against a refined one, then element kind and size, then the place and kind of "
      "the domain's rim."};
  check_default_patch(options, s);
  study_mesh(options, s);
  study_rim(options, s);
  return s;
}

}  // namespace palpate::verify
