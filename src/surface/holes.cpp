// SPDX-License-Identifier: GPL-3.0-or-later
// Liepa 2003, "Filling holes in meshes": a dynamic programme finds the triangulation of a loop of
// n points in O(n^3). Longer loops are cut up first: every k-th point makes a coarse polygon, and
// each chain between two of its corners is a polygon of its own, closed by their chord.
#include "surface/holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "surface/remesh.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;
constexpr Id kNone = CornerMesh::kNone;

// Points of the largest polygon that is triangulated at once: 100^3 / 6 triangles are weighed, in a
// millisecond. More gives a slightly smaller area on long ragged loops.
constexpr std::size_t kPolygon = 100;

// [mm] Rim of an opening at which the scan ends. Eyes and a mouth have 80 to 150, a neck 350 or
// more; a missing patch of the scalp may be on either side, and both treatments suit it.
constexpr double kCapPerimeter = 250;

using Polygon = std::vector<Id>;  // points in order, the new faces' own orientation
using Faces = std::vector<std::array<Id, 3>>;

// Whether a chord may join two points of the loop: not where the mesh has that edge already.
bool free_chord(const CornerMesh& m, Id a, Id b) {
  return !m.joined(a, b);
}

// Least-area triangulation; false where the mesh's own edges leave none.
bool triangulate_polygon(const CornerMesh& m, const Polygon& p, Faces& faces) {
  const int n = static_cast<int>(p.size());
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<double> weight(static_cast<std::size_t>(n) * n, inf);
  std::vector<int> middle(static_cast<std::size_t>(n) * n, -1);
  std::vector<std::uint8_t> allowed(static_cast<std::size_t>(n) * n, 1);
  const auto at = [n](int i, int k) { return static_cast<std::size_t>(i) * n + k; };
  for (int i = 0; i < n; ++i)
    for (int k = i + 2; k < n; ++k)
      if (i != 0 || k != n - 1) allowed[at(i, k)] = free_chord(m, p[i], p[k]);
  for (int i = 0; i + 1 < n; ++i) weight[at(i, i + 1)] = 0;
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int k = i + span;
      if (!allowed[at(i, k)]) continue;
      const Vec3 &a = m.points[p[i]], ac = m.points[p[k]] - a;
      for (int j = i + 1; j < k; ++j) {
        const double below = weight[at(i, j)] + weight[at(j, k)];
        if (below >= weight[at(i, k)]) continue;
        const double total = below + 0.5 * (m.points[p[j]] - a).cross(ac).norm();
        if (total < weight[at(i, k)]) weight[at(i, k)] = total, middle[at(i, k)] = j;
      }
    }
  if (weight[at(0, n - 1)] == inf) return false;
  std::vector<std::pair<int, int>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k - i < 2) continue;
    const int j = middle[at(i, k)];
    faces.push_back({p[i], p[j], p[k]});
    open.push_back({i, j});
    open.push_back({j, k});
  }
  return true;
}

// @return false where some polygon has no triangulation; `faces` is then incomplete
bool triangulate_loop(const CornerMesh& m, const Polygon& p, Faces& faces) {
  if (p.size() <= kPolygon) return triangulate_polygon(m, p, faces);
  const std::size_t parts = std::min(kPolygon, p.size() / 2);
  Polygon coarse;
  std::vector<Polygon> chains;
  for (std::size_t i = 0; i < parts; ++i) {
    const std::size_t from = i * p.size() / parts, to = (i + 1) * p.size() / parts;
    coarse.push_back(p[from]);
    Polygon chain;
    for (std::size_t k = from; k <= to; ++k) chain.push_back(p[k % p.size()]);
    if (chain.size() > 2 && !free_chord(m, chain.front(), chain.back())) return false;
    chains.push_back(std::move(chain));
  }
  if (!triangulate_polygon(m, coarse, faces)) return false;
  for (const Polygon& chain : chains)
    if (chain.size() > 2 && !triangulate_loop(m, chain, faces)) return false;
  return true;
}

void add_faces(CornerMesh& m, const std::vector<Id>& loop, const Faces& faces, Patch kind) {
  std::map<std::pair<Id, Id>, Id> side;
  for (const Id h : loop) side[{m.from(h), m.to(h)}] = h;
  const Id first = m.half_edges();
  for (const auto& [a, b, c] : faces) m.add_face(a, b, c, kind);
  for (Id h = first; h < m.half_edges(); ++h) side[{m.from(h), m.to(h)}] = h;
  for (Id h = first; h < m.half_edges(); ++h) m.pair(h, side.at({m.to(h), m.from(h)}));
}

void close_loop(CornerMesh& m, const std::vector<Id>& loop, Patch kind) {
  Polygon p;
  for (auto it = loop.rbegin(); it != loop.rend(); ++it) p.push_back(m.to(*it));
  Faces faces;
  if (p.size() < 3 || !triangulate_loop(m, p, faces)) {
    // A fan to a new point is always a manifold.
    faces.clear();
    Vec3 center = Vec3::Zero();
    for (const Id v : p) center += m.points[v] / static_cast<double>(p.size());
    const Id c = m.add_point(center);
    for (std::size_t i = 0; i < p.size(); ++i) faces.push_back({p[i], p[(i + 1) % p.size()], c});
  }
  add_faces(m, loop, faces, kind);
}

// An edge inside a patch: both faces are new.
bool inside_patch(const CornerMesh& m, Id h) {
  const Id g = m.twin[h];
  return g != kNone && m.patch[h / 3] != kScan && m.patch[h / 3] == m.patch[g / 3];
}

// Sum of the angles opposite an edge: more than pi where the other diagonal is better (Delaunay).
double opposite_angles(const CornerMesh& m, Id h) {
  const auto angle = [&](Id e) {
    const Vec3 u = m.points[m.from(e)] - m.points[m.apex(e)];
    const Vec3 v = m.points[m.to(e)] - m.points[m.apex(e)];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return angle(h) + angle(m.twin[h]);
}

void flip_to_delaunay(CornerMesh& m, Id first) {
  constexpr int kSweeps = 10;       // a flip moves only its neighbours; a few sweeps settle all
  constexpr double kMargin = 1e-6;  // [rad] equal angles are left alone
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::size_t flips = 0;
    for (Id h = first; h < m.half_edges(); ++h)
      if (h < m.twin[h] && inside_patch(m, h) && opposite_angles(m, h) > M_PI + kMargin &&
          m.can_flip(h)) {
        m.flip(h);
        ++flips;
      }
    if (flips == 0) return;
  }
}

// Moves inner points towards the least area: Gauss-Seidel on the cotangent Laplacian, whose weights
// leave a plane patch as it is (so no fold appears where the loop is not convex).
void relax_to_membrane(CornerMesh& m, Id first, const Progress& progress) {
  constexpr int kOuter = 12, kInner = 30;  // weights anew; sweeps with them: moves < 0.01 edge
  std::vector<Id> inner;
  std::vector<std::uint8_t> seen(m.points.size(), 0);
  for (Id h = first; h < m.half_edges(); ++h) {
    const Id v = m.from(h);
    if (seen[v]) continue;
    seen[v] = 1;
    bool all = true;
    m.around(v, [&](Id e) { all = all && m.patch[e / 3]; });
    if (all) inner.push_back(v);
  }
  const auto cotangent = [&](Id h) {
    const Vec3 u = m.points[m.from(h)] - m.points[m.apex(h)];
    const Vec3 v = m.points[m.to(h)] - m.points[m.apex(h)];
    return u.dot(v) / std::max(u.cross(v).norm(), 1e-12);
  };
  std::vector<std::vector<std::pair<Id, double>>> row(inner.size());
  for (int outer = 0; outer < kOuter; ++outer) {
    progress.step("closing holes", 0.5 + 0.5 * outer / kOuter);
    for (std::size_t i = 0; i < inner.size(); ++i) {
      row[i].clear();
      m.around(inner[i], [&](Id h) {
        const double w = cotangent(h) + cotangent(m.twin[h]);
        row[i].emplace_back(m.to(h), std::clamp(w, 1e-3, 1e3));
      });
    }
    for (int sweep = 0; sweep < kInner; ++sweep)
      for (std::size_t i = 0; i < inner.size(); ++i) {
        Vec3 sum = Vec3::Zero();
        double weight = 0;
        for (const auto& [v, w] : row[i]) sum += w * m.points[v], weight += w;
        m.points[inner[i]] = sum / weight;
      }
    flip_to_delaunay(m, first);
  }
}

}  // namespace

HoleStatistics fill_holes(CornerMesh& m, double edge, const Progress& progress) {
  const auto loops = m.border_loops();
  HoleStatistics statistics;
  statistics.filled = loops.size();
  const Id first = m.half_edges();
  for (const auto& loop : loops) {
    double perimeter = 0;
    for (const Id h : loop) perimeter += std::sqrt(m.length2(h));
    statistics.largest_perimeter = std::max(statistics.largest_perimeter, perimeter);
    progress.step("closing holes", 0.2);
    close_loop(m, loop, perimeter > kCapPerimeter ? kCap : kCover);
  }
  m.rebuild_out();
  split_long_edges(m, 4.0 / 3.0 * edge, first, true);
  flip_to_delaunay(m, first);
  relax_to_membrane(m, first, progress);
  return statistics;
}

}  // namespace palpate::surface
