// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of the stiffness stage as tables: discretisation error of the default patch, size of the
// domain, treatment of contact, speed of the batch. `bench_sweep` takes about two minutes on two
// cores, `bench_sweep --speed` a few seconds; `bench_sweep --refined` also recomputes the refined
// solutions (half an hour).
#include <fmt/format.h>

#include <chrono>
#include <cstring>

#include "fem/lanes/batch.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/refined_slab.hpp"

namespace {

using namespace palpate;
using namespace palpate::stiffness;
using Clock = std::chrono::steady_clock;

const fem::LameModuli kFlesh = fem::lame_moduli(0.045658, 0.43);
constexpr double kTool = 8;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<Vec3> slab(const PatchTemplate& t, double thickness, double first_layer) {
  PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), thickness);
  return patch_nodes(t, g, first_layer);
}

std::vector<double> press_slab(const PatchRule& rule, double thickness, double first_layer,
                               double penalty) {
  const PatchTemplate t = make_template(rule);
  fem::Cholesky cholesky(t.topology.pattern);
  const SiteCurve c = press_site(t, slab(t, thickness, first_layer), fem::neo_hookean(kFlesh),
                                 {kTool, penalty}, kSlabForces, cholesky);
  return c.travel.empty() ? std::vector<double>(kSlabForces.size(), NAN) : c.travel;
}

std::string row_of(const std::vector<double>& travel, const std::vector<double>& reference) {
  std::string row;
  for (std::size_t i = 0; i < travel.size(); ++i)
    row += fmt::format("{:9.4f} {:+6.2f} %", travel[i], 100 * (travel[i] / reference[i] - 1));
  return row;
}

void discretisation(bool recompute) {
  const double penalty = fem::default_penalty(0.045658, kTool);
  fmt::print("\nSphere R = 8 mm on a slab, travel [mm] and error against the refined patch\n");
  fmt::print("{:>6}  {:<28}", "h [mm]", "patch");
  for (const double f : kSlabForces) fmt::print("{:>16} N", f);
  fmt::print("\n");
  for (const RefinedSlab& slab_case : kRefinedSlabs) {
    std::vector<double> reference(slab_case.travel.begin(), slab_case.travel.end());
    const double h = slab_case.thickness;
    if (recompute) reference = press_slab(refined_rule(), h, 1.5, 8 * penalty);
    fmt::print("{:6.1f}  {:<28}{}\n", h, "refined", row_of(reference, reference));
    PatchRule rule = rule_for_depth(h, kTool);
    fmt::print("{:6.1f}  {:<28}{}\n", h,
               fmt::format("default, {} layers, {:.0f} mm", rule.layers, rule.rings.back().radius),
               row_of(press_slab(rule, h, rule.first_layer, penalty), reference));
    PatchRule held = rule;
    held.hold_rim = true;
    fmt::print("{:6.1f}  {:<28}{}\n", h, "rim held",
               row_of(press_slab(held, h, rule.first_layer, penalty), reference));
    fmt::print("{:6.1f}  {:<28}{}\n", h, "penalty x 10",
               row_of(press_slab(rule, h, rule.first_layer, 10 * penalty), reference));
  }
}

void speed() {
  fmt::print("\nBatch of 16 sites, 10 loads, one thread\n");
  fmt::print("{:<10}{:>8}{:>16}{:>16}{:>14}{:>12}{:>12}\n", "set", "depth", "MFlop/tissue",
             "MFlop/contact", "s per batch", "s per site", "steps/site");
  std::vector<double> forces;
  for (int i = 1; i <= 10; ++i) forces.push_back(0.5 * i);
  const std::pair<const char*, fem::lanes::InstructionSet> sets[] = {
      {"avx512", fem::lanes::InstructionSet::avx512},
      {"avx2", fem::lanes::InstructionSet::avx2},
      {"baseline", fem::lanes::InstructionSet::baseline}};
  for (const auto& [name, set] : sets) {
    if (set > fem::lanes::best_instruction_set()) continue;
    for (const double depth : {6.0, 12.0, 20.0}) {
      const PatchTemplate t = make_template(rule_for_depth(depth, kTool));
      const fem::lanes::Plan plan = fem::lanes::make_plan(t.topology);
      fem::lanes::BatchPress batch(t.topology, plan, set);
      std::vector<fem::lanes::BatchPatch> patches;
      for (int i = 0; i < 16; ++i)
        patches.push_back({slab(t, depth * (0.7 + 0.04 * i), t.rule.first_layer), {kFlesh}});
      const auto start = Clock::now();
      const auto lanes = batch.press(patches, kTool, forces);
      const double seconds = seconds_since(start);
      double steps = 0;
      for (const auto& l : lanes) steps += l.iterations / 16.0;
      fmt::print("{:<10}{:>8}{:>16.1f}{:>16.1f}{:>14.2f}{:>12.3f}{:>12.1f}\n", name, depth,
                 (plan.factor_flops - plan.contact_flops) * 1e-6, plan.contact_flops * 1e-6,
                 seconds, seconds / 16, steps);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto asked = [&](const char* word) { return argc > 1 && std::strcmp(argv[1], word) == 0; };
  if (!asked("--speed")) discretisation(asked("--refined"));
  speed();
}
