// SPDX-License-Identifier: GPL-3.0-or-later
// Indenters on a layer bonded to a rigid base, small strains: exact forces and ours.
#pragma once
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "fem/press.hpp"
#include "stiffness/patch.hpp"

namespace palpate::fem::scenes {

using stiffness::PatchRule;
using stiffness::PatchTemplate;

inline std::vector<Vec3> slab(const PatchTemplate& t, double thickness, double first_layer) {
  stiffness::PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), thickness);
  return stiffness::patch_nodes(t, g, first_layer);
}

struct ExactRow {
  std::string indenter;  ///< sphere or flat_cylinder
  double nu, a_over_h;
  double chi;    ///< travel * R / a^2 of the sphere
  double kappa;  ///< P (1 - nu^2) / (2 a E travel)
};
inline std::vector<ExactRow> exact_rows(const std::string& csv) {
  std::ifstream in(csv);
  std::vector<ExactRow> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream s(line);
    std::string cell[5];
    for (auto& c : cell) std::getline(s, c, ',');
    rows.push_back({cell[0], std::stod(cell[1]), std::stod(cell[2]),
                    cell[3].empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(cell[3]),
                    std::stod(cell[4])});
  }
  return rows;
}

/// Force [N] that brings the indenter to `travel`, in logarithms between two forces around the
/// exact one: the reference prescribes the travel and states the force. NaN where a load failed.
inline double force_at_travel(const PatchTemplate& t, const std::vector<Vec3>& nodes,
                              const LameModuli& m, const Indenter& tool, double travel,
                              double near_force) {
  const ElasticBody body(t.topology, nodes, linear_elastic(m));
  const Contact contact(t.topology, nodes, tool);
  Cholesky cholesky(t.topology.pattern);
  std::vector<double> forces;
  for (const double f : {0.3, 0.9, 1.1}) forces.push_back(f * near_force);
  PressOptions options;
  options.first_guess = 0.3 * travel;
  const PressCurve c = press(body, contact, forces, cholesky, options);
  if (!c.complete) return std::numeric_limits<double>::quiet_NaN();
  const double slope = std::log(forces[2] / forces[1]) / std::log(c.travel[2] / c.travel[1]);
  return forces[1] * std::pow(travel / c.travel[1], slope);
}

/// Disk for a sphere's contact radius a on a layer of thickness h: `per_radius` rings a contact
/// radius to 1.25 a, then a progression out to a + 5 h.
inline PatchRule sphere_rule(double a, double h, int per_radius) {
  PatchRule rule;
  for (int r = 1; 4 * r <= 5 * per_radius; ++r)
    rule.rings.push_back({r * a / per_radius, std::min(6 * r, 18)});
  rule.layers = a > 0.9 * h ? 3 : 4;
  rule.touch_radius = 1.7 * a;
  return rule;
}

/// Disk for a punch of radius a: its edge lies on a ring whose polygon has the circle's area,
/// between rings of 0.05 a, and the first layer is as thin (the pressure is singular at the edge).
/// Faces within the edge are touched.
inline PatchRule punch_rule(double a) {
  constexpr int kAround = 16;
  const double corner =
      a * std::sqrt(2 * std::numbers::pi / (kAround * std::sin(2 * std::numbers::pi / kAround)));
  PatchRule rule;
  for (const auto& [share, sectors] :
       {std::pair{0.45, 8}, {0.8, 16}, {0.95, 16}, {1.0, 16}, {1.05, 16}, {1.2, 16}, {1.6, 12}})
    rule.rings.push_back({share * corner, sectors});
  rule.layers = 5;
  rule.touch_radius = 1.01 * corner;
  return rule;
}

/// Relative error of the force on a small-strain layer of thickness 8 mm.
inline double layer_error(const ExactRow& row, int per_radius) {
  constexpr double h = 8, e = 0.045658;
  const double a = row.a_over_h * h;
  const bool sphere = row.indenter == "sphere";
  PatchRule rule = sphere ? sphere_rule(a, h, per_radius) : punch_rule(a);
  rule.hold_rim = false;
  while (rule.rings.back().radius < a + 5 * h)
    rule.rings.push_back(
        {1.6 * rule.rings.back().radius, std::max(8, rule.rings.back().sectors - 4)});
  const PatchTemplate t = stiffness::make_template(rule);
  Indenter tool;
  tool.shape = sphere ? IndenterShape::sphere : IndenterShape::flat_punch;
  tool.radius = sphere ? 200 * a : rule.touch_radius;
  tool.start = Vec3(0, 0, sphere ? tool.radius : 0);
  tool.penalty = 2000 * e / std::min(a, h);
  const double travel = sphere ? row.chi * a * a / tool.radius : 1e-3 * a;
  const double force = 2 * a * e * travel * row.kappa / (1 - row.nu * row.nu);
  const double first_layer = sphere ? std::max(0.3 * a, 0.1 * h) : 0.06 * a;
  return force_at_travel(t, slab(t, h, first_layer), lame_moduli(e, row.nu), tool, travel, force) /
             force -
         1;
}

}  // namespace palpate::fem::scenes
