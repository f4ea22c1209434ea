// SPDX-License-Identifier: GPL-3.0-or-later
// The methods that the source weighs (its chapter 2), on one slab under one load.
#include <fmt/format.h>

#include <chrono>

#include "fem/published.hpp"
#include "fem/spring_net.hpp"
#include "verify/blocks.hpp"
#include "verify/slab_case.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;
using Clock = std::chrono::steady_clock;

const std::vector<double> kForces = {0.5, 1, 2, 3, 4, 5};

struct Outcome {
  std::vector<double> depth;  // [mm] of the middle, one per load that converged
  std::string failure;
  int first_inverted = -1;  // index of a load
  double seconds = 0;
};

Outcome press_with(const SlabCase& scene, const Body& body, const std::vector<NodalLoad>& unit) {
  const auto start = Clock::now();
  Cholesky cholesky(scene.topology.pattern);
  const LoadedStates s = load_up(body, load_vector(scene.topology, unit), kForces, cholesky);
  Outcome out{{}, s.failure, -1, std::chrono::duration<double>(Clock::now() - start).count()};
  // Any law may serve to look at the shape of the elements.
  const ElasticBody shape(scene.topology, scene.slab.mesh.nodes, linear_elastic(flesh_moduli()));
  for (const Eigen::VectorXd& x : s.states) {
    if (out.first_inverted < 0 && shape.inverted_tets(x) > 0)
      out.first_inverted = static_cast<int>(out.depth.size());
    out.depth.push_back(-body.displacement(x, 0).z());
  }
  return out;
}

Outcome press_as_published(const SlabCase& scene) {
  const auto start = Clock::now();
  Cholesky cholesky(scene.topology.pattern);
  Outcome out;
  for (const PublishedSample& p : press_published(scene.topology, scene.slab.mesh.nodes, {}, 0,
                                                  -Vec3::UnitZ(), kForces, cholesky)) {
    if (out.first_inverted < 0 && p.inverted_tets > 0)
      out.first_inverted = static_cast<int>(out.depth.size());
    if (!p.at_rest && out.failure.empty())
      out.failure =
          fmt::format("not at rest after {} steps at {} N", p.steps, kForces[out.depth.size()]);
    out.depth.push_back(p.displacement);
  }
  out.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return out;
}

std::string remark(const Outcome& o) {
  if (o.first_inverted >= 0)
    return fmt::format("tissue inside out from {} N on", kForces[o.first_inverted]);
  return o.failure.empty() ? "sound" : o.failure;
}

void add(report::Page::Table& table, plot::LinePlot& plot, const char* method, const char* load,
         const char* element, const Outcome& o) {
  const auto depth = [&](std::size_t i) {
    return i < o.depth.size() ? fmt::format("{:.3f}", o.depth[i]) : std::string("none");
  };
  table.rows.push_back({method, load, element, remark(o), depth(0), depth(kForces.size() - 1),
                        fmt::format("{:.2f}", o.seconds)});
  if (std::string_view(load) != "pressure" || std::string_view(element) != "10 nodes") return;
  plot::Series series{method, o.depth, {}};
  series.y.assign(kForces.begin(), kForces.begin() + static_cast<int>(o.depth.size()));
  plot.series.push_back(series);
}

}  // namespace

Section compare_methods(const VerifyOptions& options) {
  Section s{"methods", "Methods in one table",
            "The 12 mm slab pressed with 0.5 to 5 N by each law that the source weighs: a smooth "
            "pressure of radius 8 mm, or the source's force on one node. Depth of the middle; CPU "
            "seconds for six loads."};
  report::Page::Table table{
      {"method", "load", "element", "outcome", "0.5 N [mm]", "5 N [mm]", "seconds"}, {}};
  table.text_columns = 4;
  plot::LinePlot plot{"Force against depth under a smooth pressure", "depth [mm]", "force [N]"};
  const LameModuli m = flesh_moduli();
  const SlabCase p1 = slab_case(ElementOrder::linear, kForces),
                 p2 = slab_case(ElementOrder::quadratic, kForces);
  const std::vector<std::pair<const char*, TissueLaws>> laws = {
      {"neo-Hookean", neo_hookean(m)},
      {"Mooney-Rivlin", mooney_rivlin(mooney_rivlin_from(m))},
      {"St.-Venant-Kirchhoff", st_venant_kirchhoff(m)},
      {"the same, compression resistance 500", st_venant_kirchhoff(m, 500)},
      {"corotational", corotational(m)},
      {"small-strain linear", linear_elastic(m)}};
  Outcome standard;
  for (const auto& [method, law] : laws) {
    const ElasticBody linear(p1.topology, p1.slab.mesh.nodes, law);
    add(table, plot, method, "pressure", "4 nodes", press_with(p1, linear, p1.unit));
    if (options.quick) continue;
    const ElasticBody quadratic(p2.topology, p2.slab.mesh.nodes, law);
    const Outcome o = press_with(p2, quadratic, p2.unit);
    add(table, plot, method, "pressure", "10 nodes", o);
    if (std::string_view(method) == "neo-Hookean") standard = o;
  }
  const SpringNet net(p1.topology, p1.slab.mesh.nodes, kFleshModulus);
  add(table, plot, "mass-spring net", "pressure", "edges", press_with(p1, net, p1.unit));
  const ElasticBody kirchhoff(p1.topology, p1.slab.mesh.nodes, st_venant_kirchhoff(m));
  add(table, plot, "St.-Venant-Kirchhoff, static", "one node", "4 nodes",
      press_with(p1, kirchhoff, nodal_force(0, -Vec3::UnitZ())));
  const Outcome published = press_as_published(p1);
  add(table, plot, "published: the same, dynamics to rest", "one node", "4 nodes", published);
  if (!options.quick)
    s.figures.push_back(at_least("neo-Hookean carries 5 N with no element inside out",
                                 standard.failure.empty() && standard.first_inverted < 0, 1));
  s.figures.push_back(at_least("published recipe marked where it turns tissue inside out",
                               published.first_inverted >= 0, 1, remark(published)));
  s.tables = {table};
  if (!plot.series.empty()) s.plots = {plot};
  return s;
}

}  // namespace palpate::verify
