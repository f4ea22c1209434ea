// SPDX-License-Identifier: GPL-3.0-or-later
// Columns: the middle, then ring by ring, all rings with the same sectors, so that thin rings stay
// valid however thin. A prism under a triangle of columns is cut into three tetrahedra whose
// diagonals run from the lower to the higher column number: neighbours agree.
#include "verify/slab.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::verify {
namespace {

using Edge = std::array<std::int32_t, 2>;

struct Disk {
  std::vector<Eigen::Vector2d> columns;
  std::vector<std::array<int, 3>> triangles;
};

Disk make_disk(const SlabRule& rule) {
  Disk disk;
  disk.columns.push_back(Eigen::Vector2d::Zero());
  for (const double radius : rule.rings)
    for (int s = 0; s < rule.sectors; ++s) {
      const double angle = 2 * std::numbers::pi * s / rule.sectors;
      disk.columns.push_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  const auto column = [&](std::size_t ring, int s) {
    return 1 + static_cast<int>(ring) * rule.sectors + s % rule.sectors;
  };
  for (int s = 0; s < rule.sectors; ++s)
    disk.triangles.push_back({0, column(0, s), column(0, s + 1)});
  for (std::size_t r = 1; r < rule.rings.size(); ++r)
    for (int s = 0; s < rule.sectors; ++s) {
      // Diagonals alternate: no sense of rotation is preferred.
      const int a = column(r - 1, s), b = column(r - 1, s + 1), c = column(r, s),
                d = column(r, s + 1);
      if (s % 2 == 0) {
        disk.triangles.push_back({a, c, d});
        disk.triangles.push_back({a, d, b});
      } else {
        disk.triangles.push_back({a, c, b});
        disk.triangles.push_back({b, c, d});
      }
    }
  return disk;
}

fem::TetMesh extrude(const Disk& disk, const std::vector<double>& depths) {
  const int levels = static_cast<int>(depths.size());
  fem::TetMesh mesh;
  for (const Eigen::Vector2d& c : disk.columns)
    for (const double depth : depths) mesh.nodes.push_back({c.x(), c.y(), -depth});
  const auto add = [&mesh](std::array<int, 4> n) {
    mesh.tets.insert(mesh.tets.end(), n.begin(), n.end());
    if (fem::corner_volume(mesh, mesh.size() - 1) < 0)
      std::swap(mesh.tets[mesh.tets.size() - 1], mesh.tets[mesh.tets.size() - 2]);
  };
  for (std::array<int, 3> v : disk.triangles) {
    std::sort(v.begin(), v.end());
    for (int level = 0; level + 1 < levels; ++level) {
      const auto lo = [&](int i) { return v[i] * levels + level; };
      const auto hi = [&](int i) { return v[i] * levels + level + 1; };
      add({lo(0), lo(1), lo(2), hi(2)});
      add({lo(0), lo(1), hi(1), hi(2)});
      add({lo(0), hi(0), hi(1), hi(2)});
    }
  }
  return mesh;
}

/// Puts the middle of each edge at the mean radius and the mean angle of its ends.
void round_middles(std::size_t corners, const std::vector<Edge>& edges, std::vector<Vec3>& nodes) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Eigen::Vector2d a = nodes[edges[e][0]].head<2>(), b = nodes[edges[e][1]].head<2>();
    if (a.norm() == 0 || b.norm() == 0) continue;
    const Eigen::Vector2d towards = a.normalized() + b.normalized();
    nodes[corners + e].head<2>() = 0.5 * (a.norm() + b.norm()) * towards.normalized();
  }
}

}  // namespace

Slab make_slab(const SlabRule& rule, fem::ElementOrder order) {
  constexpr double kOn = 1e-9;  // [-] relative: on the floor, on the rim
  const fem::TetMesh linear = extrude(make_disk(rule), rule.depths);
  Slab slab;
  std::vector<Edge> edges;
  slab.mesh = order == fem::ElementOrder::linear ? linear : fem::to_quadratic(linear, &edges);
  if (rule.round) round_middles(linear.nodes.size(), edges, slab.mesh.nodes);
  const double floor = -rule.depths.back() * (1 - kOn), rim = rule.rings.back() * (1 - kOn);
  // A middle is held when both its ends are: on the floor, or on the rim.
  std::vector<std::uint8_t> side;
  for (const Vec3& p : linear.nodes)
    side.push_back((p.z() < floor ? 1 : 0) | (rule.hold_rim && p.head<2>().norm() > rim ? 2 : 0));
  for (const Edge& e : edges) side.push_back(side[e[0]] & side[e[1]]);
  for (const std::uint8_t s : side) slab.held.push_back(s != 0);

  const fem::FaceList all = fem::boundary_faces(slab.mesh);
  const int stride = fem::face_nodes(order);
  for (std::size_t f = 0; f < all.size(); f += stride) {
    const bool touchable = std::all_of(&all[f], &all[f] + 3, [&](std::int32_t n) {
      const Vec3& p = slab.mesh.nodes[n];
      return p.z() > -kOn && p.head<2>().norm() <= rule.touch_radius;
    });
    if (touchable) slab.touchable.insert(slab.touchable.end(), &all[f], &all[f] + stride);
  }
  return slab;
}

std::vector<double> graded_depths(double thickness, double first, double growth) {
  std::vector<double> depths = {0};
  for (double step = first; depths.back() < thickness * (1 - 1e-9); step *= growth)
    depths.push_back(depths.back() + step);
  // The last level overshoots; leaving it out may fit better.
  const bool shorter =
      depths.size() > 2 && thickness / depths[depths.size() - 2] < depths.back() / thickness;
  if (shorter) depths.pop_back();
  const double scale = thickness / depths.back();
  for (double& d : depths) d *= scale;
  return depths;
}

}  // namespace palpate::verify
