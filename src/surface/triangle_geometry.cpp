// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_geometry.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::surface {

static TrianglePoint on_corner(const Vec3& p, int corner) {
  Vec3 w = Vec3::Zero();
  w[corner] = 1;
  return {p, w, static_cast<Feature>(static_cast<int>(Feature::vertex0) + corner)};
}

// Point at parameter s in (0, 1) of edge k, from `a` (corner k) to `b` (corner k+1).
static TrianglePoint on_edge(const Vec3& a, const Vec3& b, double s, int k) {
  Vec3 w = Vec3::Zero();
  w[k] = 1 - s;
  w[(k + 1) % 3] = s;
  return {a + s * (b - a), w, static_cast<Feature>(static_cast<int>(Feature::edge0) + k)};
}

static TrianglePoint closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b, int k) {
  const Vec3 ab = b - a;
  const double s = ab.dot(p - a), length2 = ab.squaredNorm();
  if (s <= 0 || length2 == 0) return on_corner(a, k);
  if (s >= length2) return on_corner(b, (k + 1) % 3);
  return on_edge(a, b, s / length2, k);
}

// A sliver whose area is lost to rounding is its three edges.
static TrianglePoint closest_on_edges(const Vec3& p, const std::array<const Vec3*, 3>& v) {
  TrianglePoint best = closest_on_segment(p, *v[0], *v[1], 0);
  for (int k = 1; k < 3; ++k) {
    const TrianglePoint other = closest_on_segment(p, *v[k], *v[(k + 1) % 3], k);
    if ((other.point - p).squaredNorm() < (best.point - p).squaredNorm()) best = other;
  }
  return best;
}

TrianglePoint closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return on_corner(a, 0);
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return on_corner(b, 1);
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return on_corner(c, 2);

  // Twice the squared area, below which the signed areas va, vb, vc are noise.
  const double area2 = ab.cross(ac).squaredNorm();
  const double scale = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  constexpr double kSliver = 1e-24;  // [-] (height / longest edge)^2 at rounding level
  if (area2 <= kSliver * scale * scale) return closest_on_edges(p, {&a, &b, &c});

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return on_edge(a, b, d1 / (d1 - d3), 0);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return on_edge(b, c, (d4 - d3) / ((d4 - d3) + (d5 - d6)), 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return on_edge(c, a, 1 - d2 / (d2 - d6), 2);

  const double sum = va + vb + vc;
  const Vec3 w(va / sum, vb / sum, vc / sum);
  return {a + w[1] * ab + w[2] * ac, w, Feature::face};
}

std::optional<TriangleCrossing> cross_plane(const Vec3& origin, const Vec3& direction,
                                            const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, n = ab.cross(ac);
  const double slope = n.dot(direction);
  if (slope == 0) return std::nullopt;
  const double t = n.dot(a - origin) / slope;
  const Vec3 q = origin + t * direction - a;
  const double area2 = n.squaredNorm();
  Vec3 w(0, q.cross(ac).dot(n) / area2, ab.cross(q).dot(n) / area2);
  w[0] = 1 - w[1] - w[2];
  w = w.cwiseMax(0.0);
  const double sum = w.sum();
  if (!std::isfinite(t) || !(sum > 0)) return std::nullopt;
  return TriangleCrossing{t, w / sum};
}

}  // namespace palpate::surface
