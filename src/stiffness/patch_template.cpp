// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/patch_template.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace palpate::stiffness {
namespace {

using std::numbers::pi;

/// Every second ring is turned by half a sector, so that equal rings give even triangles.
double angle_of(const std::vector<Ring>& rings, int ring, int sector) {
  if (ring == 0) return 0;
  const double turn = ring % 2 == 0 ? 0.5 : 0.0;
  return 2 * pi * (sector + turn) / rings[ring - 1].sectors;
}

/// Triangles between two rings: advance along the ring whose next point lies first in angle.
void zip_rings(const std::vector<Ring>& rings, int r, const std::vector<int>& first,
               std::vector<Triangle>& out) {
  const int m = rings[r - 2].sectors, n = rings[r - 1].sectors;
  const int a0 = first[r - 1], b0 = first[r];
  // Start where the inner point precedes or meets the outer one.
  int i = 0, j = 0;
  const auto inner = [&](int k) { return angle_of(rings, r - 1, k); };
  const auto outer = [&](int k) { return angle_of(rings, r, k); };
  while (i < m || j < n) {
    const bool step_outer = i == m || (j < n && outer(j) + outer(j + 1) <= inner(i) + inner(i + 1));
    if (step_outer) {
      out.push_back({a0 + i % m, b0 + j % n, b0 + (j + 1) % n});
      ++j;
    } else {
      out.push_back({a0 + i % m, b0 + j % n, a0 + (i + 1) % m});
      ++i;
    }
  }
}

std::vector<Triangle> triangulate(const std::vector<Ring>& rings) {
  std::vector<int> first = {0, 1};  // first column of each ring
  for (const Ring& r : rings) first.push_back(first.back() + r.sectors);
  std::vector<Triangle> out;
  for (int s = 0; s < rings[0].sectors; ++s)
    out.push_back({0, 1 + s, 1 + (s + 1) % rings[0].sectors});
  for (int r = 2; r <= static_cast<int>(rings.size()); ++r) zip_rings(rings, r, first, out);
  return out;
}

/// Three tetrahedra per prism; diagonals run from the lower to the higher column number, so that
/// neighbours agree.
fem::TetMesh extrude(const PatchTemplate& t, const std::vector<Triangle>& triangles) {
  fem::TetMesh mesh;
  for (const Column& c : t.columns)
    for (int level = 0; level <= t.rule.layers; ++level)
      mesh.nodes.push_back({c.x, c.y, -static_cast<double>(level)});
  const auto add = [&mesh](std::array<int, 4> n) {
    mesh.tets.insert(mesh.tets.end(), n.begin(), n.end());
    if (fem::corner_volume(mesh, mesh.size() - 1) < 0)
      std::swap(mesh.tets[mesh.tets.size() - 1], mesh.tets[mesh.tets.size() - 2]);
  };
  for (Triangle v : triangles) {
    std::sort(v.begin(), v.end());
    for (int level = 0; level < t.rule.layers; ++level) {
      const auto lo = [&](int i) { return t.corner(v[i], level); };
      const auto hi = [&](int i) { return t.corner(v[i], level + 1); };
      add({lo(0), lo(1), lo(2), hi(2)});
      add({lo(0), lo(1), hi(1), hi(2)});
      add({lo(0), hi(0), hi(1), hi(2)});
    }
  }
  return mesh;
}

/// Faces on the skin within the touch radius.
fem::FaceList touchable_faces(const fem::TetMesh& quadratic, double radius) {
  const fem::FaceList all = fem::boundary_faces(quadratic);
  fem::FaceList out;
  const int stride = fem::face_nodes(quadratic.order);
  for (std::size_t f = 0; f < all.size(); f += stride) {
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = quadratic.nodes[all[f + i]];
      inside = inside && p.z() == 0 && p.head<2>().norm() <= radius;
    }
    if (inside) out.insert(out.end(), &all[f], &all[f] + stride);
  }
  return out;
}

/// The bone side, and the rim where the rule holds it; a middle node is held when its edge lies in
/// one of the two.
std::vector<std::uint8_t> held_nodes(const PatchTemplate& t, const fem::TetMesh& mesh) {
  constexpr std::uint8_t kBone = 1, kRim = 2;
  std::vector<std::uint8_t> side(mesh.nodes.size(), 0);
  const int last_ring = static_cast<int>(t.rule.rings.size());
  for (int c = 0; c < static_cast<int>(t.columns.size()); ++c)
    for (int level = 0; level <= t.rule.layers; ++level) {
      if (level == t.rule.layers) side[t.corner(c, level)] |= kBone;
      if (t.rule.hold_rim && t.columns[c].ring == last_ring) side[t.corner(c, level)] |= kRim;
    }
  for (std::size_t e = 0; e < t.edges.size(); ++e)
    side[t.corners() + e] = side[t.edges[e][0]] & side[t.edges[e][1]];
  return side;
}

}  // namespace

PatchRule default_rule(double tool_radius, double outer_radius, int layers) {
  // Fractions of the tool's radius under it, then a geometric progression to the rim.
  constexpr std::array<Ring, 4> kUnderTool = {{{0.25, 6}, {0.5, 12}, {0.775, 12}, {1.125, 12}}};
  constexpr std::array<int, 3> kBeyond = {12, 8, 8};
  PatchRule rule;
  rule.layers = layers;
  rule.touch_radius = 1.6 * tool_radius;
  for (const Ring& r : kUnderTool) rule.rings.push_back({r.radius * tool_radius, r.sectors});
  const double growth = std::pow(outer_radius / rule.rings.back().radius, 1.0 / kBeyond.size());
  for (const int sectors : kBeyond)
    rule.rings.push_back({rule.rings.back().radius * growth, sectors});
  return rule;
}

std::vector<Column> make_columns(const std::vector<Ring>& rings) {
  std::vector<Column> columns = {Column{}};
  int before = 0;  // first column of the ring inside
  for (int r = 1; r <= static_cast<int>(rings.size()); ++r) {
    const int first = static_cast<int>(columns.size());
    for (int s = 0; s < rings[r - 1].sectors; ++s) {
      const double angle = angle_of(rings, r, s);
      Column c{rings[r - 1].radius * std::cos(angle), rings[r - 1].radius * std::sin(angle), r, 0};
      double best = -2;
      for (int i = before; i < first; ++i) {
        const double cosine = std::cos(angle - std::atan2(columns[i].y, columns[i].x));
        if (cosine > best + 1e-9) best = cosine, c.inner = i;
      }
      columns.push_back(c);
    }
    before = first;
  }
  return columns;
}

PatchTemplate make_template(const PatchRule& rule) {
  if (rule.rings.empty() || rule.layers < 1) throw InputError("a patch needs rings and layers");
  PatchTemplate t{rule, {}, {}, {}};
  t.columns = make_columns(rule.rings);
  const fem::TetMesh linear = extrude(t, triangulate(rule.rings));
  const fem::TetMesh mesh = fem::to_quadratic(linear, &t.edges);
  t.topology =
      fem::make_topology(mesh, held_nodes(t, mesh), touchable_faces(mesh, rule.touch_radius));
  return t;
}

}  // namespace palpate::stiffness
