// SPDX-License-Identifier: Apache-2.0
#include "mesh_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

namespace palpate::data_test {
namespace {

using Edge = std::pair<std::size_t, std::size_t>;

std::vector<Edge> directed_edges(const SurfaceMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      edges.emplace_back(static_cast<std::size_t>(t[k]), static_cast<std::size_t>(t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// Points whose corners are not all linked through shared edges. On a closed oriented mesh each
/// corner leads to the next one around its point; one fan is one cycle.
std::size_t count_pinched(const SurfaceMesh& mesh) {
  std::map<Edge, std::size_t> leaving;  // directed edge a -> b: the triangle's third point
  std::vector<std::size_t> valence(mesh.points.size(), 0);
  std::vector<std::size_t> first(mesh.points.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(t[k]);
      const auto b = static_cast<std::size_t>(t[(k + 1) % 3]);
      leaving[{a, b}] = static_cast<std::size_t>(t[(k + 2) % 3]);
      first[a] = b;
      ++valence[a];
    }
  std::size_t pinched = 0;
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (valence[p] == 0) continue;
    std::size_t steps = 0, at = first[p];
    do {
      const auto next = leaving.find({p, at});
      if (next == leaving.end()) break;
      at = next->second;
      ++steps;
    } while (at != first[p] && steps <= valence[p]);
    if (steps != valence[p]) ++pinched;
  }
  return pinched;
}

/// Nearest point of a triangle (Ericson 2005, "Real-Time Collision Detection", section 5.1.5).
Vec3 nearest_on(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  const double scale = 1.0 / (va + vb + vc);
  return a + ab * (vb * scale) + ac * (vc * scale);
}

const Vec3& corner(const SurfaceMesh& mesh, const Triangle& t, int k) {
  return mesh.points[static_cast<std::size_t>(t[k])];
}

}  // namespace

Topology topology(const SurfaceMesh& mesh) {
  Topology out;
  const std::vector<Edge> edges = directed_edges(mesh);
  for (const auto& [a, b] : edges) {
    const auto twins = std::equal_range(edges.begin(), edges.end(), Edge{b, a});
    const auto same = std::equal_range(edges.begin(), edges.end(), Edge{a, b});
    if (twins.second - twins.first != 1 || same.second - same.first != 1) ++out.unpaired_edges;
  }
  std::vector<std::size_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  std::vector<char> used(mesh.points.size(), 0);
  for (const auto& [a, b] : edges) {
    used[a] = used[b] = 1;
    parent[root_of(parent, a)] = root_of(parent, b);
  }
  for (std::size_t p = 0; p < parent.size(); ++p) {
    if (!used[p]) ++out.unused_points;
    if (used[p] && root_of(parent, p) == p) ++out.components;
  }
  out.pinched_points = count_pinched(mesh);
  out.euler = static_cast<long>(mesh.points.size() - out.unused_points) -
              static_cast<long>(edges.size() / 2) + static_cast<long>(mesh.triangles.size());
  return out;
}

std::vector<double> edge_lengths(const SurfaceMesh& mesh) {
  std::vector<double> out;
  for (const auto& [a, b] : directed_edges(mesh))
    if (a < b) out.push_back((mesh.points[a] - mesh.points[b]).norm());
  std::sort(out.begin(), out.end());
  return out;
}

double worst_quality(const SurfaceMesh& mesh) {
  double worst = 1;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 ab = corner(mesh, t, 1) - corner(mesh, t, 0);
    const Vec3 bc = corner(mesh, t, 2) - corner(mesh, t, 1);
    const Vec3 ca = corner(mesh, t, 0) - corner(mesh, t, 2);
    const double squares = ab.squaredNorm() + bc.squaredNorm() + ca.squaredNorm();
    worst = std::min(worst, 2 * std::numbers::sqrt3 * ab.cross(ca).norm() / squares);
  }
  return worst;
}

double mirror_error(const SurfaceMesh& mesh, double reach) {
  using Cell = std::array<int, 3>;
  const auto cell_of = [reach](const Vec3& p) {
    return Cell{static_cast<int>(std::floor(p.x() / reach)),
                static_cast<int>(std::floor(p.y() / reach)),
                static_cast<int>(std::floor(p.z() / reach))};
  };
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) cells[cell_of(mesh.points[i])].push_back(i);
  double worst = 0;
  for (const Vec3& p : mesh.points) {
    const Vec3 q(-p.x(), p.y(), p.z());
    const Cell c = cell_of(q);
    double best = reach;
    for (int n = 0; n < 27; ++n) {
      const auto found = cells.find({c[0] + n / 9 - 1, c[1] + n / 3 % 3 - 1, c[2] + n % 3 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t i : found->second) best = std::min(best, (mesh.points[i] - q).norm());
    }
    worst = std::max(worst, best);
  }
  return worst;
}

double distance_to(const SurfaceMesh& mesh, const Vec3& point) {
  double best = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 q = nearest_on(point, corner(mesh, t, 0), corner(mesh, t, 1), corner(mesh, t, 2));
    best = std::min(best, (q - point).norm());
  }
  return best;
}

bool inside(const SurfaceMesh& mesh, const Vec3& point) {
  // Solid angle of each triangle (Van Oosterom and Strackee 1983); 4 pi in all when inside.
  double angle = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = corner(mesh, t, 0) - point;
    const Vec3 b = corner(mesh, t, 1) - point;
    const Vec3 c = corner(mesh, t, 2) - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)),
                            la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2 * std::numbers::pi;
}

}  // namespace palpate::data_test
