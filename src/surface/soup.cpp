// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/soup.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/error.hpp"
#include "surface/edge_groups.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;
constexpr Id kNone = CornerMesh::kNone;

// Points nearer than this are one: above the rounding of single-precision files in any unit, far
// below the spacing of any scanner. The fixed limit keeps a stray point far away from welding all.
constexpr double kWeld = 1e-5;      // [-] of the box diagonal; 5 um on a head
constexpr double kWeldMost = 0.01;  // [mm]

// For each point the lowest-numbered point that it coincides with. Points are swept along a skew
// direction, in which even a regular grid has few ties.
std::vector<Id> weld_targets(const std::vector<Vec3>& points, double tolerance) {
  const Vec3 sweep = Vec3(0.5377, 0.6421, 0.5466).normalized();
  std::vector<std::pair<double, Id>> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    order[i] = {sweep.dot(points[i]), static_cast<Id>(i)};
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<Id> parent(points.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Id v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  const double tolerance2 = tolerance * tolerance;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Vec3& p = points[order[i].second];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (order[j].first - order[i].first > tolerance) break;
      if ((points[order[j].second] - p).squaredNorm() > tolerance2) continue;
      const Id a = root(order[i].second), b = root(order[j].second);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = root(static_cast<Id>(v));
  return parent;
}

// Points that faces use, welded; faces with three different corners and an area, each once.
SurfaceMesh clean_soup(const SurfaceMesh& scan, RepairReport& report) {
  const double diagonal = bounding_box(scan.points).size().norm();
  const double tolerance = std::min(kWeld * diagonal, kWeldMost);
  const std::vector<Id> target = weld_targets(scan.points, tolerance);
  std::vector<Id> number(scan.points.size(), kNone);
  SurfaceMesh mesh;
  for (std::size_t v = 0; v < scan.points.size(); ++v) {
    if (target[v] != static_cast<Id>(v)) {
      ++report.duplicate_points;
      continue;
    }
    number[v] = static_cast<Id>(mesh.points.size());
    mesh.points.push_back(scan.points[v]);
  }
  using Key = std::tuple<Id, Id, Id, Id>;
  std::vector<Key> keys;
  keys.reserve(scan.triangles.size());
  for (const Triangle& t : scan.triangles) {
    Triangle w;
    for (int k = 0; k < 3; ++k) w[k] = number[target[t[k]]];
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) {
      ++report.degenerate_faces;
      continue;
    }
    Triangle s = w;
    std::sort(s.begin(), s.end());
    keys.emplace_back(s[0], s[1], s[2], static_cast<Id>(mesh.triangles.size()));
    mesh.triangles.push_back(w);
  }
  tbb::parallel_sort(keys.begin(), keys.end());
  std::vector<std::uint8_t> repeated(mesh.triangles.size(), 0);
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const auto& [a, b, c, f] = keys[i];
    const auto& [pa, pb, pc, pf] = keys[i - 1];
    if (a == pa && b == pb && c == pc) repeated[f] = 1, ++report.duplicate_faces;
  }
  std::size_t kept = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if (!repeated[f]) mesh.triangles[kept++] = mesh.triangles[f];
  mesh.triangles.resize(kept);
  return mesh;
}

// Of several faces at one edge, those that continue each other most smoothly belong together.
void pair_flattest(const SurfaceMesh& mesh, std::span<const Id> sides, std::vector<Id>& twin) {
  const auto start = [&](Id h) { return mesh.triangles[h / 3][h % 3]; };
  const auto wing = [&](Id h) -> Vec3 {  // from the edge towards the apex
    const Triangle& t = mesh.triangles[h / 3];
    const Vec3& a = mesh.points[t[h % 3]];
    const Vec3 e = (mesh.points[t[(h + 1) % 3]] - a).stableNormalized();
    const Vec3 w = mesh.points[t[(h + 2) % 3]] - a;
    return (w - e.dot(w) * e).stableNormalized();
  };
  struct Candidate {
    double bend;
    Id a, b;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size(); ++j) {
      const double same_way = start(sides[i]) == start(sides[j]) ? 1 : 0;
      candidates.push_back({wing(sides[i]).dot(wing(sides[j])) + same_way, sides[i], sides[j]});
    }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) {
    return std::tie(x.bend, x.a, x.b) < std::tie(y.bend, y.a, y.b);
  });
  for (const Candidate& c : candidates)
    if (twin[c.a] == kNone && twin[c.b] == kNone) twin[c.a] = c.b, twin[c.b] = c.a;
}

std::vector<Id> pair_sides(const SurfaceMesh& mesh, RepairReport& report) {
  std::vector<Id> twin(3 * mesh.triangles.size(), kNone);
  for_each_edge(mesh.triangles, mesh.points.size(), [&](std::span<const Id> sides) {
    if (sides.size() == 2) twin[sides[0]] = sides[1], twin[sides[1]] = sides[0];
    if (sides.size() <= 2) return;
    ++report.nonmanifold_spots;
    pair_flattest(mesh, sides, twin);
  });
  return twin;
}

// Walks over pieces; turns faces so that neighbours agree, by majority of each piece; where a walk
// closes on itself the wrong way round (a Moebius strip), the edge is cut. Returns the piece of
// each face.
std::vector<Id> orient_pieces(SurfaceMesh& mesh, std::vector<Id>& twin, RepairReport& report) {
  const std::size_t n = mesh.triangles.size();
  std::vector<Id> piece(n, kNone), walk;
  std::vector<std::uint8_t> turned(n, 0);
  Id pieces = 0;
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (piece[seed] != kNone) continue;
    walk.assign(1, static_cast<Id>(seed));
    piece[seed] = pieces;
    std::size_t turns = 0;
    for (std::size_t i = 0; i < walk.size(); ++i) {
      const Id f = walk[i];
      for (Id h = 3 * f; h < 3 * f + 3; ++h) {
        const Id g = twin[h];
        if (g == kNone) continue;
        const bool same_way = mesh.triangles[f][h % 3] == mesh.triangles[g / 3][g % 3];
        const std::uint8_t wanted = same_way ? 1 - turned[f] : turned[f];
        if (piece[g / 3] == kNone) {
          piece[g / 3] = pieces;
          turned[g / 3] = wanted;
          turns += wanted;
          walk.push_back(g / 3);
        } else if (turned[g / 3] != wanted) {
          twin[h] = twin[g] = kNone;
          ++report.nonmanifold_spots;
        }
      }
    }
    if (2 * turns > walk.size())
      for (const Id f : walk) turned[f] = 1 - turned[f];
    ++pieces;
  }
  // Turning (a, b, c) to (a, c, b) renames sides 0 and 2.
  const auto renamed = [&](Id h) {
    return h == kNone || !turned[h / 3] || h % 3 == 1 ? h : h / 3 * 3 + 2 - h % 3;
  };
  for (std::size_t f = 0; f < n; ++f)
    if (turned[f]) {
      std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
      std::swap(twin[3 * f], twin[3 * f + 2]);
    }
  for (Id& t : twin) t = renamed(t);
  return piece;
}

// Keeps the piece of the largest area.
CornerMesh largest_piece(const SurfaceMesh& mesh, const std::vector<Id>& twin,
                         const std::vector<Id>& piece, RepairReport& report) {
  report.components = 1 + static_cast<std::size_t>(*std::max_element(piece.begin(), piece.end()));
  std::vector<double> area(report.components, 0);
  for (std::size_t f = 0; f < piece.size(); ++f) {
    const auto& [a, b, c] = mesh.triangles[f];
    const Vec3& p = mesh.points[a];
    area[piece[f]] += 0.5 * (mesh.points[b] - p).cross(mesh.points[c] - p).norm();
  }
  const Id kept = static_cast<Id>(std::max_element(area.begin(), area.end()) - area.begin());
  if (!(area[kept] > 0)) throw InputError("the scan has no triangle with an area; scan again");
  CornerMesh m;
  m.points = mesh.points;
  for (std::size_t f = 0; f < piece.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (piece[f] == kept) {
      m.corner.insert(m.corner.end(), t.begin(), t.end());
    } else {
      m.corner.insert(m.corner.end(), 3, kNone);
      ++report.dropped_triangles;
    }
  }
  m.twin = twin;
  m.patch.assign(piece.size(), 0);
  return m;
}

// Two edges between the same two points cannot be told apart by index: the later ones get a point
// in the middle; two open sides are zipped. @return whether any edge was split
bool split_double_edges(CornerMesh& m) {
  const SurfaceMesh view = m.to_surface();
  std::vector<Id> split;
  for_each_edge(view.triangles, view.points.size(), [&](std::span<const Id> sides) {
    const bool open = m.twin[sides[0]] == kNone && m.twin[sides.back()] == kNone;
    if (sides.size() == 2 && open && m.from(sides[0]) == m.to(sides[1])) m.pair(sides[0], sides[1]);
    if (sides.size() <= 2) return;
    for (const Id h : sides.subspan(1))
      if (h != m.twin[sides[0]] && (m.twin[h] == kNone || h < m.twin[h])) split.push_back(h);
  });
  m.rebuild_out();
  for (const Id h : split) m.split(h, 0.5 * (m.points[m.from(h)] + m.points[m.to(h)]));
  return !split.empty();
}

void turn_inside_out(CornerMesh& m) {
  for (Id f = 0; f < m.faces(); ++f) {
    std::swap(m.corner[3 * f + 1], m.corner[3 * f + 2]);
    std::swap(m.twin[3 * f], m.twin[3 * f + 2]);
  }
  for (Id& t : m.twin)
    if (t != kNone) t = t / 3 * 3 + 2 - t % 3;
  m.rebuild_out();
}

}  // namespace

double capped_volume(const CornerMesh& m) {
  const Vec3 origin = bounding_box(m.points).center();
  double volume = 0;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    volume += (a - origin).dot((b - origin).cross(c - origin)) / 6;
  };
  for (Id h = 0; h < m.half_edges(); h += 3)
    if (m.alive(h)) add(m.points[m.from(h)], m.points[m.to(h)], m.points[m.apex(h)]);
  for (const auto& loop : m.border_loops()) {
    Vec3 center = Vec3::Zero();
    for (const Id h : loop) center += m.points[m.from(h)] / static_cast<double>(loop.size());
    for (const Id h : loop) add(m.points[m.to(h)], m.points[m.from(h)], center);
  }
  return volume;
}

CornerMesh manifold_from_soup(const SurfaceMesh& scan, RepairReport& report) {
  SurfaceMesh mesh = clean_soup(scan, report);
  if (mesh.triangles.empty())
    throw InputError("the scan has no triangle with an area (all points coincide?); scan again");
  std::vector<Id> twin = pair_sides(mesh, report);
  const std::vector<Id> piece = orient_pieces(mesh, twin, report);
  CornerMesh m = largest_piece(mesh, twin, piece, report);
  report.nonmanifold_spots += m.split_fans();
  m.compact();
  while (split_double_edges(m)) m.rebuild_out();
  report.winding_inverted = capped_volume(m) < 0;
  if (report.winding_inverted) turn_inside_out(m);
  return m;
}

}  // namespace palpate::surface
