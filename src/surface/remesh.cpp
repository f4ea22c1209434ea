// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/remesh.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;
constexpr Id kNone = CornerMesh::kNone;

// [-] cosine of the largest turn (60 degrees) of a face's normal in one edit: more is a fold.
constexpr double kMaxTurn = 0.5;

// [-] height over longest edge below which a face is a sliver; 0.87 is equilateral. Edits never
// make one where there was none, and flips remove them.
constexpr double kSliver = 0.2;

double height_ratio(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest2 =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest2 > 0 ? (b - a).cross(c - a).norm() / longest2 : 0;
}

// Whether every face around v, but those of the edge to `gone`, keeps its direction and shape and
// its edges stay below the limit when v moves to p.
bool may_move(const CornerMesh& m, Id v, const Vec3& p, Id gone, double limit2) {
  bool ok = true;
  m.around(v, [&](Id h) {
    if (!ok) return;
    const Id b = m.to(h), c = m.apex(h);
    if (b != gone && (m.points[b] - p).squaredNorm() > limit2) ok = false;
    if (b == gone || c == gone) return;
    const Vec3 old = m.area_vector(h);
    const Vec3 now = (m.points[b] - p).cross(m.points[c] - p);
    const double shape = height_ratio(p, m.points[b], m.points[c]);
    const double old_shape = height_ratio(m.points[v], m.points[b], m.points[c]);
    // A face without area has no direction to keep; one that would lose its area is refused.
    if (shape == 0 || shape < std::min(kSliver, old_shape) ||
        (old_shape > 0 && old.dot(now) < kMaxTurn * old.norm() * now.norm()))
      ok = false;
  });
  return ok;
}

// One flag per point: 1 on a rim.
std::vector<std::uint8_t> rim_points(const CornerMesh& m) {
  std::vector<std::uint8_t> on_rim(m.points.size(), 0);
  for (Id h = 0; h < m.half_edges(); ++h)
    if (m.alive(h) && m.rim(h)) on_rim[m.from(h)] = 1;
  return on_rim;
}

std::size_t collapse_shorter(CornerMesh& m, double shorter, double limit) {
  const double shorter2 = shorter * shorter, limit2 = limit * limit;
  const std::vector<std::uint8_t> on_rim = rim_points(m);
  std::size_t done = 0;
  for (Id h = 0; h < m.half_edges(); ++h) {
    if (!m.alive(h) || m.length2(h) >= shorter2 || !m.can_collapse(h)) continue;
    const Id a = m.from(h), b = m.to(h);
    // The surviving point is b: on a rim it must be a point of that rim, and two points of rims may
    // only merge along one. The twin offers the other end.
    if (on_rim[a] && (!on_rim[b] || !m.rim(h))) continue;
    const Vec3 end = m.points[b], middle = 0.5 * (m.points[a] + end);
    // The middle shrinks neither side; where it folds a face, one end may still do.
    for (const Vec3& p : {on_rim[b] ? end : middle, end}) {
      if (!may_move(m, a, p, b, limit2) || !may_move(m, b, p, a, limit2)) continue;
      m.collapse(h);
      m.points[b] = p;
      ++done;
      break;
    }
  }
  return done;
}

std::vector<int> valences(const CornerMesh& m) {
  std::vector<int> valence(m.points.size(), 0);
  for (const Id v : m.corner)
    if (v != kNone) ++valence[v];
  return valence;
}

// Whether the edge of h may become the other diagonal without a fold, and should: to even out
// valences where the four points are nearly in one plane, or to be rid of a sliver.
bool wants_flip(const CornerMesh& m, Id h, const std::vector<int>& valence) {
  const Id g = m.twin[h], a = m.from(h), b = m.to(h), c = m.apex(h), d = m.apex(g);
  if (valence[a] <= 3 || valence[b] <= 3) return false;
  const auto& p = m.points;
  const double shape_old = std::min(height_ratio(p[a], p[b], p[c]), height_ratio(p[b], p[a], p[d]));
  const double shape_new = std::min(height_ratio(p[d], p[c], p[a]), height_ratio(p[c], p[d], p[b]));
  const bool sliver = shape_old < kSliver && shape_new > shape_old;
  const auto excess = [&](Id v, int change) {
    const int e = valence[v] + change - 6;
    return e * e;
  };
  const bool evener = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1) <
                      excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0);
  if (!sliver && !(evener && shape_new >= std::min(kSliver, shape_old))) return false;

  const Vec3 n1 = m.area_vector(h), n2 = m.area_vector(g), mean = n1 + n2;
  const Vec3 m1 = (p[c] - p[d]).cross(p[a] - p[d]), m2 = (p[d] - p[c]).cross(p[b] - p[c]);
  const double size = kMaxTurn * mean.norm();
  if (m1.dot(mean) < m1.norm() * size || m2.dot(mean) < m2.norm() * size) return false;
  // The new edge may not cut a corner that the old one followed. A sliver has no direction.
  constexpr double kFlat = 0.8;  // [-] cosine of the fold along the old edge (37 degrees)
  return sliver || n1.dot(n2) >= kFlat * n1.norm() * n2.norm();
}

void flip_edges(CornerMesh& m) {
  std::vector<int> valence = valences(m);
  for (Id h = 0; h < m.half_edges(); ++h) {
    if (!m.alive(h) || h > m.twin[h]) continue;
    if (m.patch[h / 3] != m.patch[m.twin[h] / 3]) continue;  // faces keep what they stand for
    if (!wants_flip(m, h, valence) || !m.can_flip(h)) continue;
    --valence[m.from(h)], --valence[m.to(h)];
    m.flip(h);
    ++valence[m.from(h)], ++valence[m.to(h)];
  }
}

// The nearest point of the target whose side faces the same way; p itself where there is none, so
// that no point jumps across a thin sheet.
Vec3 project(const SurfaceQuery& target, const std::vector<Vec3>& target_normal, const Vec3& p,
             const Vec3& normal) {
  const ClosestPoint c = target.closest(p);
  return target_normal[c.triangle].dot(normal) > 0 ? c.point : p;
}

// Each point towards the area-weighted middle of its faces within the tangent plane, then onto the
// target. All move at once from the old positions; a move that would fold a face is undone.
void relax(CornerMesh& m, const SurfaceQuery& target, const std::vector<Vec3>& target_normal) {
  const std::vector<std::uint8_t> on_rim = rim_points(m);
  std::vector<Vec3> goal(m.points.size());
  tbb::parallel_for(std::size_t{0}, m.points.size(), [&](std::size_t i) {
    const Id v = static_cast<Id>(i);
    if (m.out[v] == kNone || on_rim[i]) return;
    const Vec3& p = m.points[v];
    Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
    double weight = 0;
    m.around(v, [&](Id h) {
      const Vec3 n = m.area_vector(h);
      const double area = n.norm();
      middle += area * (p + m.points[m.to(h)] + m.points[m.apex(h)]) / 3;
      normal += n;
      weight += area;
    });
    normal.stableNormalize();
    if (weight == 0) {
      goal[i] = p;
      return;
    }
    const Vec3 step = middle / weight - p;
    goal[i] = project(target, target_normal, p + step - normal.dot(step) * normal, normal);
  });
  for (std::size_t i = 0; i < m.points.size(); ++i) {
    const Id v = static_cast<Id>(i);
    if (m.out[v] == kNone || on_rim[i]) continue;
    if (keeps_direction(m, v, goal[i])) m.points[v] = goal[i];
  }
}

}  // namespace

bool keeps_direction(const CornerMesh& m, Id v, const Vec3& p) {
  return may_move(m, v, p, kNone, std::numeric_limits<double>::infinity());
}

void split_long_edges(CornerMesh& m, double longer, Id first, bool patch_only) {
  const auto eligible = [&](Id h) {
    return m.alive(h) && (!patch_only || m.patch[h / 3] || m.patch[m.twin[h] / 3]);
  };
  double longest2 = 0;
  for (Id h = first; h < m.half_edges(); ++h)
    if (eligible(h)) longest2 = std::max(longest2, m.length2(h));
  // Longest first: a short side of a needle, split early, would only make more needles.
  for (double limit2 = longest2; limit2 > longer * longer;) {
    limit2 = std::max(0.5 * limit2, longer * longer);
    for (Id h = first; h < m.half_edges(); ++h)  // also over the half-edges that splits append
      while (eligible(h) && m.length2(h) > limit2)
        m.split(h, 0.5 * (m.points[m.from(h)] + m.points[m.to(h)]));
  }
}

void thin(CornerMesh& m, double edge, const Progress& progress) {
  double sum = 0;
  for (Id h = 0; h < m.half_edges(); ++h) sum += std::sqrt(m.length2(h));
  constexpr double kGrowth = 1.5;  // [-] per pass; larger passes leave points of high valence
  double length = sum / m.half_edges();
  while (length < edge) {
    length = std::min(kGrowth * length, edge);
    progress.step("thinning", length / edge);
    collapse_shorter(m, length, 2 * length);
    m.compact();
    flip_edges(m);
  }
}

void remesh(CornerMesh& m, const SurfaceQuery& target, double edge, int iterations,
            const Progress& progress) {
  const std::vector<Vec3> target_normal = triangle_normals(target.mesh());
  for (int i = 0; i < iterations; ++i) {
    progress.step("remeshing", static_cast<double>(i) / iterations);
    split_long_edges(m, 4.0 / 3.0 * edge);
    collapse_shorter(m, 4.0 / 5.0 * edge, 4.0 / 3.0 * edge);
    m.compact();
    flip_edges(m);
    relax(m, target, target_normal);
  }
  flip_edges(m);
}

}  // namespace palpate::surface
