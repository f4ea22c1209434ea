// SPDX-License-Identifier: GPL-3.0-or-later
// The reference solves the Fredholm equation of the contact problem (Lebedev & Ufliand 1958; Hayes
// et al. 1972) and tabulates chi = travel R / a^2 and kappa = P (1 - nu^2) / (2 a E travel) against
// a/h. Small strains are asked for, so the sphere is 200 contact radii large and the travel is
// below 1 % of the contact radius.
#include "verify/bonded_layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include "core/error.hpp"
#include "fem/press.hpp"
#include "verify/blocks.hpp"
#include "verify/slab.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using namespace fem;

constexpr double kThickness = 8;  // [mm]; the errors depend on a/h alone
// Near incompressibility the four points of a quadratic tet, which hold the volume at four places,
// are more than its nodes can give, and it locks: part of the volume's energy is then integrated at
// the centres. Under a punch all of it is. Under a sphere all of it is too soft by 1 %, so nine
// tenths are; and where the contact is wider than the layer is thick, the pressure is confined,
// single points let it through (4 % too soft) and the full rule is within 1 %.
constexpr double kPunchLocks = 0.44, kSphereLocks = 0.47;  // Poisson's ratios
constexpr double kShareAtCentre = 0.9;                     // [-]

int sectors(bool refined) {
  return refined ? 20 : 12;
}

/// Rings outwards from the last one to where the layer no longer feels the tool, four thicknesses.
void add_far_rings(SlabRule& rule, double a, bool refined) {
  const double growth = refined ? 1.4 : 1.7;
  const double widest = (refined ? 0.7 : 1.4) * kThickness;
  const double rim = a + 4 * kThickness;
  while (rule.rings.back() < rim) {
    const double last = rule.rings.back();
    rule.rings.push_back(std::min(growth * last, last + widest));
  }
}

SlabRule sphere_rule(double a, bool refined) {
  SlabRule rule;
  // Four a contact radius, none wider than a quarter of the thickness.
  int per_radius = std::max(4, static_cast<int>(std::ceil(4 * a / kThickness - 1e-9)));
  if (refined) per_radius *= 2;
  for (int r = 1; 4 * r <= 5 * per_radius; ++r) rule.rings.push_back(r * a / per_radius);
  add_far_rings(rule, a, refined);
  const double first = std::min((refined ? 0.125 : 0.25) * a, kThickness / (refined ? 8 : 4));
  rule.depths = graded_depths(kThickness, first, refined ? 1.3 : 1.5);
  rule.touch_radius = 1.7 * a;
  return rule;
}

/// Rings at distances from the edge that grow fourfold from `edge` on, inwards and outwards.
/// Quadratic elements outside the edge cannot follow the root in the displacement there: the punch
/// looks wider by a share of `edge`, so the error goes with `edge`, not with the number of rings.
SlabRule punch_rule(double a, bool refined) {
  const double edge = refined ? 0.003 : 0.006;  // [-] of the radius
  SlabRule rule;
  std::vector<double> distance;
  for (double d = edge, step = 3 * edge; d < 0.7; d += step, step *= 3) distance.push_back(d);
  for (auto d = distance.rbegin(); d != distance.rend(); ++d) rule.rings.push_back((1 - *d) * a);
  rule.rings.push_back(a);
  for (const double d : distance) rule.rings.push_back((1 + d) * a);
  add_far_rings(rule, a, refined);
  const double first = std::min(edge * a, kThickness / (refined ? 6 : 4));
  rule.depths = graded_depths(kThickness, first, refined ? 2 : 2.2);
  rule.touch_radius = 1.001 * a;
  return rule;
}

TissueLaws layer_laws(const LameModuli& m, const ExactRow& row) {
  if (!row.sphere) {
    if (row.nu > kPunchLocks) return linear_elastic_centred(m);
    return linear_elastic(m);
  }
  if (row.nu < kSphereLocks || row.a_over_h > 1) return linear_elastic(m);
  TissueLaws laws(linear_elastic({(1 - kShareAtCentre) * m.lambda, m.mu}));
  laws.at_centre = linear_elastic({kShareAtCentre * m.lambda, 0});
  return laws;
}

}  // namespace

std::vector<ExactRow> read_exact_rows(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::string line;
  if (!std::getline(in, line))
    throw InputError(csv.string() + ": the table of exact forces cannot be read");
  std::vector<ExactRow> rows;
  for (int number = 2; std::getline(in, line); ++number) {
    std::istringstream s(line);
    std::string cell[5];
    for (auto& c : cell) std::getline(s, c, ',');
    try {
      const bool sphere = cell[0] == "sphere";
      rows.push_back({sphere, std::stod(cell[1]), std::stod(cell[2]),
                      sphere ? std::stod(cell[3]) : std::numeric_limits<double>::quiet_NaN(),
                      std::stod(cell[4])});
    } catch (const std::exception&) {
      throw InputError(fmt::format("{}:{}: not a row of the table", csv.string(), number));
    }
  }
  return rows;
}

LayerResult press_layer(const ExactRow& row, LayerMesh kind) {
  const auto start = std::chrono::steady_clock::now();
  const double a = row.a_over_h * kThickness;
  const bool refined = kind == LayerMesh::refined;
  SlabRule rule = row.sphere ? sphere_rule(a, refined) : punch_rule(a, refined);
  rule.round = true;
  rule.sectors = sectors(refined);
  const Slab slab = make_slab(rule, ElementOrder::quadratic);
  const Topology t = make_topology(slab.mesh, slab.held, slab.touchable);

  Indenter tool;
  tool.shape = row.sphere ? IndenterShape::sphere : IndenterShape::flat_punch;
  tool.radius = row.sphere ? 200 * a : rule.touch_radius;
  tool.start = Vec3(0, 0, row.sphere ? tool.radius : 0);
  tool.bilateral = !row.sphere;
  tool.penalty = (row.sphere ? 2e3 : 1e5) * kFleshModulus / std::min(a, kThickness);
  const double travel = row.sphere ? row.chi * a * a / tool.radius : 1e-3 * a;
  const double exact = 2 * a * kFleshModulus * travel * row.kappa / (1 - row.nu * row.nu);

  const ElasticBody body(t, slab.mesh.nodes, layer_laws(lame_moduli(kFleshModulus, row.nu), row));
  const Contact contact(t, slab.mesh.nodes, tool);
  Cholesky cholesky(t.pattern);
  const PressForces pressed = press_to(body, contact, std::span(&travel, 1), cholesky);
  if (!pressed.complete) throw SolveError("indentation of a layer: " + pressed.failure);
  return {pressed.force[0] / exact - 1, t.unknowns(),
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

Section check_bonded_layer(const VerifyOptions& options) {
  Section s{"layer", "Indentation of a bonded layer",
            "A sphere and a flat punch on a linear elastic layer bonded to a rigid floor: force at "
            "a given travel against the exact solution. Standard mesh: four rings of 10-node "
            "elements a contact radius under a sphere, none wider than a quarter of the thickness; "
            "under a punch rings "
            "down to 0.6 % of its radius at the edge. The refined mesh has twice the rings under a "
            "sphere, 0.3 % at a punch's edge and 20 sectors for 12."};
  report::Page::Table table{{"tool", "nu", "a/h", "standard", "refined", "unknowns"}, {}};
  const std::vector<double> poissons =
      options.quick ? std::vector{0.43} : std::vector{0.3, 0.43, 0.45, 0.495};
  const std::vector<double> radii =
      options.quick ? std::vector{0.5} : std::vector{0.2, 0.5, 1.0, 2.0};
  double worst[2][2] = {{0, 0}, {0, 0}};
  plot::LinePlot plot{"Error of the force, standard mesh", "a/h", "error [%]"};
  for (const ExactRow& row : read_exact_rows(options.exact_layer_csv)) {
    const auto among = [](double x, const std::vector<double>& list) {
      return std::find(list.begin(), list.end(), x) != list.end();
    };
    if (!among(row.nu, poissons) || !among(row.a_over_h, radii)) continue;
    const LayerResult standard = press_layer(row, LayerMesh::standard);
    worst[row.sphere][0] = std::max(worst[row.sphere][0], std::abs(standard.error));
    // The hardest Poisson's ratios decide about the refined mesh, and cost enough.
    const bool refine = !options.quick && (row.nu == 0.3 || row.nu == 0.495);
    LayerResult refined;
    if (refine) {
      refined = press_layer(row, LayerMesh::refined);
      worst[row.sphere][1] = std::max(worst[row.sphere][1], std::abs(refined.error));
    }
    table.rows.push_back({row.sphere ? "sphere" : "flat punch", fmt::format("{}", row.nu),
                          fmt::format("{}", row.a_over_h),
                          fmt::format("{:+.2f} %", 100 * standard.error),
                          refine ? fmt::format("{:+.2f} %", 100 * refined.error) : "",
                          fmt::format("{}", standard.unknowns)});
    const std::string name = fmt::format("{} {}", row.sphere ? "sphere" : "punch", row.nu);
    auto at = std::find_if(plot.series.begin(), plot.series.end(),
                           [&](const plot::Series& one) { return one.name == name; });
    if (at == plot.series.end()) at = plot.series.insert(at, plot::Series{name, {}, {}});
    at->x.push_back(row.a_over_h);
    at->y.push_back(100 * standard.error);
  }
  for (const bool sphere : {false, true}) {
    const std::string tool = sphere ? "sphere on a bonded layer" : "flat punch on a bonded layer";
    s.figures.push_back(at_most(tool + ", standard mesh", worst[sphere][0], 0.02));
    if (!options.quick)
      s.figures.push_back(at_most(tool + ", refined mesh", worst[sphere][1], 0.005));
  }
  s.tables = {table};
  if (!options.quick) s.plots = {plot};
  return s;
}

}  // namespace palpate::verify
