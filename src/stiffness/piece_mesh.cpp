// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/piece_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace palpate::stiffness {
namespace {

constexpr double kShort = 0.9;         // [-] of the wanted size: edges below it are joined
constexpr double kLeastQuality = 0.2;  // [-] of the regular tetrahedron's, or the worst before
constexpr double kLeastCosine = 0.5;   // between a boundary face and what it becomes
constexpr double kOffBoundary = 0.08;  // [-] of the distance from the origin

/// Volume over that of the regular tetrahedron with the same mean squared edge; < 0: inverted.
double quality(const std::array<Vec3, 4>& p) {
  double squares = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) squares += (p[i] - p[j]).squaredNorm();
  const double edge = std::sqrt(squares / 6);
  return (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) * std::sqrt(2.0) / (edge * edge * edge);
}

bool has(const Tetrahedron& t, std::int32_t node) {
  return std::find(t.begin(), t.end(), node) != t.end();
}

void sort_unique(std::vector<std::int32_t>& v) {
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
}

}  // namespace

PieceMesh::PieceMesh(TissuePiece piece) : piece_(std::move(piece)), tets_(piece_.nodes.size()) {
  for (std::size_t t = 0; t < piece_.tets.size(); ++t)
    for (const std::int32_t n : piece_.tets[t]) tets_[n].push_back(static_cast<std::int32_t>(t));
}

double PieceMesh::length(const Edge& e) const {
  return (piece_.nodes[e.first] - piece_.nodes[e.second]).norm();
}

Vec3 PieceMesh::middle(const Edge& e) const {
  return 0.5 * (piece_.nodes[e.first] + piece_.nodes[e.second]);
}

std::vector<std::int32_t> PieceMesh::star(std::int32_t node) const {
  std::vector<std::int32_t> out;
  for (const std::int32_t t : tets_[node])
    if (piece_.tets[t][0] >= 0 && has(piece_.tets[t], node)) out.push_back(t);
  sort_unique(out);
  return out;
}

std::vector<std::int32_t> PieceMesh::ring(const Edge& e) const {
  std::vector<std::int32_t> out;
  for (const std::int32_t t : star(e.first))
    if (has(piece_.tets[t], e.second)) out.push_back(t);
  return out;
}

std::vector<std::int32_t> PieceMesh::neighbours(std::int32_t node) const {
  std::vector<std::int32_t> out;
  for (const std::int32_t t : star(node))
    for (const std::int32_t n : piece_.tets[t])
      if (n != node) out.push_back(n);
  sort_unique(out);
  return out;
}

std::vector<PieceMesh::Face> PieceMesh::boundary(std::int32_t node) const {
  std::vector<Face> all, once;
  for (const std::int32_t t : star(node))
    for (int skip = 0; skip < 4; ++skip) {
      if (piece_.tets[t][skip] == node) continue;
      Face f;
      for (int i = 0, k = 0; i < 4; ++i)
        if (i != skip) f[k++] = piece_.tets[t][i];
      std::sort(f.begin(), f.end());
      all.push_back(f);
    }
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool twice =
        (i > 0 && all[i] == all[i - 1]) || (i + 1 < all.size() && all[i] == all[i + 1]);
    if (!twice) once.push_back(all[i]);
  }
  return once;
}

int PieceMesh::kind_of(const Face& f) const {
  if (piece_.skin[f[0]] && piece_.skin[f[1]] && piece_.skin[f[2]]) return 1;
  return piece_.held[f[0]] && piece_.held[f[1]] && piece_.held[f[2]] ? 2 : 4;
}

bool PieceMesh::may_follow_boundary(std::int32_t gone, std::int32_t kept, double keep,
                                    double tolerance) const {
  const std::vector<Face> faces = boundary(gone);
  if (faces.empty()) return true;
  if (piece_.nodes[gone].norm() < keep) return false;
  const auto contains = [](const Face& f, std::int32_t n) {
    return f[0] == n || f[1] == n || f[2] == n;
  };
  int kinds = 0, along = 0, sides = 0;
  for (const Face& f : faces) {
    kinds |= kind_of(f);
    if (contains(f, kept)) along |= kind_of(f), ++sides;
  }
  // Within one surface, or along the border between two.
  if (sides != 2 || along != kinds || kinds == 7) return false;
  const auto normal = [&](const Face& f, std::int32_t from, const Vec3& to) {
    Vec3 p[3];
    for (int i = 0; i < 3; ++i) p[i] = f[i] == from ? to : piece_.nodes[f[i]];
    return (p[1] - p[0]).cross(p[2] - p[0]).normalized().eval();
  };
  const Vec3 &old = piece_.nodes[gone], &now = piece_.nodes[kept];
  for (const Face& f : faces) {
    if (contains(f, kept)) continue;
    const Vec3 after = normal(f, gone, now);
    if (!(normal(f, gone, old).dot(after) > kLeastCosine)) return false;
    if (std::abs(after.dot(old - now)) > tolerance) return false;
  }
  return true;
}

bool PieceMesh::same_link(std::int32_t gone, std::int32_t kept) const {
  const std::vector<std::int32_t> of_gone = neighbours(gone), of_kept = neighbours(kept);
  std::vector<std::int32_t> common, around;
  std::set_intersection(of_gone.begin(), of_gone.end(), of_kept.begin(), of_kept.end(),
                        std::back_inserter(common));
  const std::vector<std::int32_t> tets = ring(edge_of(gone, kept));
  for (const std::int32_t t : tets)
    for (const std::int32_t n : piece_.tets[t])
      if (n != gone && n != kept) around.push_back(n);
  sort_unique(around);
  if (common != around) return false;
  // An edge seen from both ends must belong to a tetrahedron with both.
  const auto opposite = [&](std::int32_t node) {
    std::vector<Edge> out;
    for (const std::int32_t t : star(node))
      for (const std::int32_t a : piece_.tets[t])
        for (const std::int32_t b : piece_.tets[t])
          if (a < b && a != node && b != node) out.emplace_back(a, b);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  };
  const std::vector<Edge> from_gone = opposite(gone), from_kept = opposite(kept);
  std::vector<Edge> both;
  std::set_intersection(from_gone.begin(), from_gone.end(), from_kept.begin(), from_kept.end(),
                        std::back_inserter(both));
  return std::all_of(both.begin(), both.end(), [&](const Edge& e) {
    return std::any_of(tets.begin(), tets.end(), [&](std::int32_t t) {
      return has(piece_.tets[t], e.first) && has(piece_.tets[t], e.second);
    });
  });
}

bool PieceMesh::stays_sound(std::int32_t gone, std::int32_t kept, const Size& size) const {
  double worst_before = 1, worst_after = 1;
  for (const std::int32_t t : star(gone)) {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = piece_.nodes[piece_.tets[t][i]];
    worst_before = std::min(worst_before, quality(p));
    if (has(piece_.tets[t], kept)) continue;
    for (int i = 0; i < 4; ++i)
      if (piece_.tets[t][i] == gone) p[i] = piece_.nodes[kept];
    worst_after = std::min(worst_after, quality(p));
    for (const std::int32_t n : piece_.tets[t]) {
      if (n == gone) continue;
      const Edge e = edge_of(n, kept);
      if (length(e) > size(middle(e))) return false;
    }
  }
  return worst_after > 0 && worst_after >= std::min(kLeastQuality, worst_before);
}

void PieceMesh::join(std::int32_t gone, std::int32_t kept) {
  for (const std::int32_t t : star(gone)) {
    Tetrahedron& tet = piece_.tets[t];
    if (has(tet, kept)) {
      tet[0] = -1;
    } else {
      std::replace(tet.begin(), tet.end(), gone, kept);
      tets_[kept].push_back(t);
    }
  }
  tets_[gone].clear();
}

void PieceMesh::coarsen(const Size& size, double keep) {
  using Entry = std::pair<double, Edge>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto consider = [&](const Edge& e) {
    const double share = length(e) / size(middle(e));
    if (share < kShort) queue.push({share, e});
  };
  const auto consider_around = [&](std::int32_t node) {
    for (const std::int32_t n : neighbours(node)) consider(edge_of(node, n));
  };
  for (std::size_t n = 0; n < piece_.nodes.size(); ++n)
    for (const std::int32_t m : neighbours(static_cast<std::int32_t>(n)))
      if (static_cast<std::int32_t>(n) < m) consider({static_cast<std::int32_t>(n), m});
  while (!queue.empty()) {
    const Edge e = queue.top().second;
    queue.pop();
    if (ring(e).empty()) continue;
    const double tolerance = kOffBoundary * middle(e).norm();
    for (const auto& [gone, kept] : {std::pair(e.second, e.first), std::pair(e.first, e.second)}) {
      if (gone == 0 || !may_follow_boundary(gone, kept, keep, tolerance) ||
          !same_link(gone, kept) || !stays_sound(gone, kept, size))
        continue;
      join(gone, kept);
      consider_around(kept);
      break;
    }
  }
}

void PieceMesh::refine(const Size& size, std::size_t most) {
  std::priority_queue<std::pair<double, Edge>> queue;
  const auto consider = [&](const Tetrahedron& t) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        const Edge e = edge_of(t[i], t[j]);
        if (length(e) > size(middle(e))) queue.push({length(e), e});
      }
  };
  std::size_t alive = 0;
  for (const Tetrahedron& t : piece_.tets)
    if (t[0] >= 0) consider(t), ++alive;
  while (!queue.empty() && alive < most) {
    const Edge e = queue.top().second;
    queue.pop();
    const std::vector<std::int32_t> around = ring(e);
    if (around.empty()) continue;
    const std::size_t first_new = piece_.tets.size();
    bisect(e, around);
    alive += around.size();
    for (const std::int32_t t : around) consider(piece_.tets[t]);
    for (std::size_t t = first_new; t < piece_.tets.size(); ++t) consider(piece_.tets[t]);
  }
}

void PieceMesh::bisect(const Edge& e, const std::vector<std::int32_t>& around) {
  const auto added = static_cast<std::int32_t>(piece_.nodes.size());
  bool skin = false, held = false;  // on a face, not through the flesh between two of them
  for (const Face& f : boundary(e.first)) {
    if (f[0] != e.second && f[1] != e.second && f[2] != e.second) continue;
    skin = skin || kind_of(f) == 1;
    held = held || (piece_.held[f[0]] && piece_.held[f[1]] && piece_.held[f[2]]);
  }
  piece_.nodes.push_back(middle(e));
  piece_.skin.push_back(skin);
  piece_.held.push_back(held);
  tets_.emplace_back();
  for (const std::int32_t t : around) {
    const auto second = static_cast<std::int32_t>(piece_.tets.size());
    piece_.tets.push_back(piece_.tets[t]);
    std::replace(piece_.tets[t].begin(), piece_.tets[t].end(), e.second, added);
    std::replace(piece_.tets[second].begin(), piece_.tets[second].end(), e.first, added);
    tets_[added].push_back(t);
    for (const std::int32_t n : piece_.tets[second]) tets_[n].push_back(second);
  }
}

TissuePiece PieceMesh::piece() const {
  TissuePiece out;
  std::vector<std::int32_t> number(piece_.nodes.size(), -1);
  for (std::size_t n = 0; n < piece_.nodes.size(); ++n) {
    if (n > 0 && star(static_cast<std::int32_t>(n)).empty()) continue;
    number[n] = static_cast<std::int32_t>(out.nodes.size());
    out.nodes.push_back(piece_.nodes[n]);
    out.skin.push_back(piece_.skin[n]);
    out.held.push_back(piece_.held[n]);
  }
  for (const Tetrahedron& t : piece_.tets)
    if (t[0] >= 0) out.tets.push_back({number[t[0]], number[t[1]], number[t[2]], number[t[3]]});
  return out;
}

}  // namespace palpate::stiffness
