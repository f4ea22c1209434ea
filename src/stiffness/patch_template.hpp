// SPDX-License-Identifier: GPL-3.0-or-later
// The one connectivity that every site shares: a disk of rings and sectors, extruded into layers.
//
// A column is a point of the disk; it carries layers + 1 corner nodes from the skin (level 0) to
// the bone. Columns are parallel to the press axis, so that each tetrahedron has a third of
// (triangle area) x (length of one column edge) as its volume: positive wherever the tissue has
// thickness.
#pragma once
#include <vector>

#include "fem/topology.hpp"

namespace palpate::stiffness {

struct Ring {
  double radius = 0;  ///< [mm]
  int sectors = 0;
};
struct PatchRule {
  std::vector<Ring> rings;  ///< ascending radius, without the middle
  int layers = 2;
  double first_layer = 2.5;  ///< [mm] thickest layer under the skin; the others grow
  double touch_radius = 0;   ///< [mm] skin faces whose corners lie within may be touched
  bool hold_rim = true;      ///< outermost ring held like the bone, or free
};
/// Rings for a sphere of `tool_radius` on a domain of `outer_radius` [mm] (docs/method/sweep.md).
[[nodiscard]] PatchRule default_rule(double tool_radius, double outer_radius, int layers);

struct Column {
  double x = 0, y = 0;  ///< [mm] in the tangent plane of the site
  int ring = 0;         ///< 0: the middle
  int inner = -1;       ///< column of the ring before that lies nearest in angle
};

struct PatchTemplate {
  PatchRule rule;
  std::vector<Column> columns;
  std::vector<std::array<std::int32_t, 2>> edges;  ///< corner nodes of each middle node, in order
  fem::Topology topology;                          ///< quadratic, with travel

  [[nodiscard]] int corner(int column, int level) const {
    return column * (rule.layers + 1) + level;
  }
  /// Element layer of a tetrahedron, 0 right under the skin.
  [[nodiscard]] int element_layer(int tet) const { return tet / 3 % rule.layers; }
  [[nodiscard]] int corners() const { return static_cast<int>(columns.size()) * (rule.layers + 1); }
};
/// Columns of a disk: the middle, then ring by ring.
[[nodiscard]] std::vector<Column> make_columns(const std::vector<Ring>& rings);
/// @throws InputError for a rule without rings or layers
[[nodiscard]] PatchTemplate make_template(const PatchRule& rule);

}  // namespace palpate::stiffness
