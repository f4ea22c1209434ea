// SPDX-License-Identifier: Apache-2.0
// Limit cases of the two-flank solution, depth d against both, cos = n1 . n2:
//   cos -> 1 (one plane)   lambda = d / (1 + cos) each, push d along n
//   cos = 0 (right angle)  lambda = d each, push sqrt(2) d along the bisector
//   cos -> -1 (slot)       lambda = d each, pushes cancel
#include "haptics/crease.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::haptics {

namespace {

// Cosines of the angles at which two flanks begin to be two contacts, and are: as the proxy sees
// them, and as the blended normal turns between them.
const double kCreaseCosine = std::cos(kCreaseAngle), kTwoCosine = std::cos(2 * kCreaseAngle);
const double kTurnCosine = std::cos(0.5 * kCreaseAngle);
const double kTwoTurnsCosine = std::cos(1.5 * kCreaseAngle);

struct Flank {
  SurfacePoint at;
  Vec3 normal;  // unit, from the surface to the proxy's centre
  double share =
      1;  // [-] 0 where it is the same contact as an earlier flank, 1 where it is another
  double depth = 0;  // [mm] e_j
  double push = 0;   // [mm] lambda_j
};

struct Flanks {
  std::array<Flank, Contact::kMost> flank;
  int count = 0;
};

// Direction from the surface to the centre; at a face's inside it is exact whatever the distance.
Vec3 outward(const ContactMesh& mesh, const SurfacePoint& at, const Vec3& center, bool behind) {
  if (at.on.feature == Feature::face) return mesh.face_normal(at.triangle);
  const Vec3 away = behind ? Vec3(at.on.point - center) : Vec3(center - at.on.point);
  const double length = away.norm();
  constexpr double kTooNear = 1e-9;  // [mm] no direction left
  return length > kTooNear ? Vec3(away / length) : mesh.side_normal(at).normalized();
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// What the proxy rests on already, as the tree asks for it.
BoxTree::Rest resting(double radius, const Vec3& proxy, const Flanks& flanks) {
  BoxTree::Rest rest;
  rest.proxy = proxy;
  rest.radius = radius;
  rest.count = flanks.count;
  for (int j = 0; j < flanks.count; ++j) {
    rest.points[j] = flanks.flank[j].at.on.point;
    rest.normals[j] = flanks.flank[j].normal;
  }
  // Points of one sphere closer than this are seen under less than kCreaseAngle.
  rest.apart = 2 * radius * std::sin(0.5 * kCreaseAngle);
  rest.cosine = kCreaseCosine;
  return rest;
}

// Takes the triangle's point for `best` where it is another contact, and nearer to the proxy.
void consider(const ContactMesh& mesh, const BoxTree::Rest& rest, std::int32_t triangle,
              SurfacePoint& best) {
  const SurfacePoint s = mesh.measure(triangle, rest.proxy);
  if (s.distance2 > best.distance2 || (s.distance2 == best.distance2 && triangle > best.triangle))
    return;
  for (int j = 0; j < rest.count; ++j)
    if ((s.on.point - rest.points[j]).squaredNorm() < rest.apart * rest.apart) return;
  if (mesh.side_normal(s).dot(rest.proxy - s.on.point) > 0) best = s;
}

// Nearest point to `proxy` within the reach that belongs to none of the flanks so far.
SurfacePoint next_flank(const ContactMesh& mesh, double radius, double reach, const Vec3& proxy,
                        const Flanks& flanks) {
  BoxTree::Rest rest = resting(radius, proxy, flanks);
  rest.radius = reach;
  SurfacePoint best;
  best.distance2 = reach * reach;
  mesh.tree.visit_others(rest, [&](std::int32_t triangle, bool) {
    consider(mesh, rest, triangle, best);
    return best.distance2;
  });
  return best;
}

// The coupling of two flanks in A; both shares scale it.
double coupling(const Flank& a, const Flank& b) {
  return std::max(a.normal.dot(b.normal), 0.0) * a.share * b.share;
}

// lambda of two flanks; with both pushing, det = 1 - c^2 > 0 since flanks that share are apart.
void share_between_two(double c, double e0, double e1, double& l0, double& l1) {
  const double det = 1 - c * c;
  l0 = e0 - c * e1;
  l1 = e1 - c * e0;
  if (l0 > 0 && l1 > 0) {
    l0 /= det;
    l1 /= det;
  } else {  // one rests on the other's push
    const bool first = l0 > l1;
    l0 = first ? std::max(e0, 0.0) : 0;
    l1 = first ? 0 : std::max(e1, 0.0);
  }
}

// The complementarity problem A lambda >= e, lambda >= 0 in closed form. A is positive definite: a
// Gram matrix of unit vectors stays so when its negative entries become 0 (for three vectors with
// one pair beyond a right angle, det = 1 - cos^2 a - cos^2 b >= -cos(a + b) cos(a - b) > 0, since
// a + b is then more than a right angle), and so under shares from 0 to 1 with ones on the
// diagonal. The solution is therefore unique and continuous. Sets of pushing flanks are tried from
// all to one; the first whose pushes are positive and that leaves the others enough depth is it.
void share_push(Flanks& flanks) {
  auto& f = flanks.flank;
  if (flanks.count == 2) {
    share_between_two(coupling(f[0], f[1]), f[0].depth, f[1].depth, f[0].push, f[1].push);
    return;
  }
  const double c01 = coupling(f[0], f[1]), c02 = coupling(f[0], f[2]), c12 = coupling(f[1], f[2]);
  const double e0 = f[0].depth, e1 = f[1].depth, e2 = f[2].depth;
  // Cramer's rule on the rows of the adjugate.
  const double a00 = 1 - c12 * c12, a11 = 1 - c02 * c02, a22 = 1 - c01 * c01;
  const double a01 = c02 * c12 - c01, a02 = c01 * c12 - c02, a12 = c01 * c02 - c12;
  const double det = a00 + c01 * a01 + c02 * a02;
  const double l0 = a00 * e0 + a01 * e1 + a02 * e2;
  const double l1 = a01 * e0 + a11 * e1 + a12 * e2;
  const double l2 = a02 * e0 + a12 * e1 + a22 * e2;
  constexpr double kSingular = 1e-9;  // [-] three flanks in one plane of directions
  if (l0 >= 0 && l1 >= 0 && l2 >= 0 && det > kSingular) {
    f[0].push = l0 / det;
    f[1].push = l1 / det;
    f[2].push = l2 / det;
    return;
  }
  // One at least does not push. The pair that leaves the third no depth is the answer; rounding
  // may leave each a little, then the least.
  double least = std::numeric_limits<double>::infinity();
  std::array<double, Contact::kMost> best{};
  const std::array<double, 3> c = {c12, c02, c01};
  for (int out = 0; out < Contact::kMost; ++out) {
    const int i = (out + 1) % 3, j = (out + 2) % 3;
    double li = 0, lj = 0;
    share_between_two(c[out], f[i].depth, f[j].depth, li, lj);
    const double left = f[out].depth - c[j] * li - c[i] * lj;
    if (left >= least) continue;
    least = left;
    best[out] = 0;
    best[i] = li;
    best[j] = lj;
  }
  for (int j = 0; j < Contact::kMost; ++j) f[j].push = best[j];
}

// [-] Smooth step of the angle between two unit vectors, given its cosine. The angle itself is only
// worked out in between.
double apart_by(double cosine, double low, double high, double cosine_low, double cosine_high) {
  if (cosine >= cosine_low) return 0;
  if (cosine <= cosine_high) return 1;
  return smooth_step(low, high, std::acos(cosine));
}

// How much each later flank is a contact of its own: by the angle under which the proxy sees it
// beside the earlier ones, and by the turn of the blended normal between the two, which is what
// the hand would feel as a jump. Facets of a smooth valley differ in the first, not in the second.
void find_shares(const ContactMesh& mesh, Flanks& flanks) {
  std::array<Vec3, Contact::kMost> blended;
  for (int j = 0; j < flanks.count; ++j) blended[j] = mesh.blended_normal(flanks.flank[j].at);
  for (int j = 1; j < flanks.count; ++j) {
    double seen = -1;  // cosines of the smallest angles
    double turn = -1;
    for (int k = 0; k < j; ++k) {
      seen = std::max(seen, flanks.flank[j].normal.dot(flanks.flank[k].normal));
      turn = std::max(turn, blended[j].dot(blended[k]));
    }
    flanks.flank[j].share =
        apart_by(seen, kCreaseAngle, 2 * kCreaseAngle, kCreaseCosine, kTwoCosine) *
        apart_by(turn, 0.5 * kCreaseAngle, 1.5 * kCreaseAngle, kTurnCosine, kTwoTurnsCosine);
  }
}

// Depth of the tool against each flank's plane of contact, seen from the proxy.
void measure_flank(const ContactMesh& mesh, double radius, const Vec3& center, const Vec3& proxy,
                   Flank& flank) {
  flank.normal = outward(mesh, flank.at, proxy, false);
  flank.depth = radius - std::sqrt(flank.at.distance2) + flank.normal.dot(proxy - center);
}

Vec3 place_proxy(const Vec3& center, const Flanks& flanks) {
  Vec3 proxy = center;
  for (int j = 0; j < flanks.count; ++j)
    proxy += flanks.flank[j].share * flanks.flank[j].push * flanks.flank[j].normal;
  return proxy;
}

// Newton's steps towards the proxy that rests on all flanks; they bend little within a step, and on
// flat facets the second step finds the proxy where the first left it.
Vec3 settle(const ContactMesh& mesh, double radius, const Vec3& center, Vec3 proxy,
            Flanks& flanks) {
  constexpr int kSteps = 4;
  constexpr double kStill = 1e-9;  // [mm] moved less than this: the force changes by as many nN
  for (int step = 0; step < kSteps; ++step) {
    for (int j = 0; j < flanks.count; ++j) {
      flanks.flank[j].at = mesh.descend(proxy, flanks.flank[j].at);
      measure_flank(mesh, radius, center, proxy, flanks.flank[j]);
    }
    find_shares(mesh, flanks);
    share_push(flanks);
    const Vec3 before = proxy;
    proxy = place_proxy(center, flanks);
    if ((proxy - before).squaredNorm() < kStill * kStill) break;
  }
  return proxy;
}

Flanks first_flank(const ContactMesh& mesh, double radius, const Vec3& center,
                   const SurfacePoint& nearest, bool behind) {
  const double distance = std::sqrt(nearest.distance2);
  Flanks flanks;
  flanks.count = 1;
  flanks.flank[0].at = nearest;
  flanks.flank[0].normal = outward(mesh, nearest, center, behind);
  flanks.flank[0].depth = behind ? radius + distance : radius - distance;
  flanks.flank[0].push = flanks.flank[0].depth;
  return flanks;
}

Contact one_point(const ContactMesh& mesh, const SurfacePoint& at, double depth) {
  Contact contact;
  contact.count = 1;
  contact.points[0] = {at, 1};
  contact.depth = depth;
  contact.normal = mesh.blended_normal(at);
  return contact;
}

Contact many_points(const ContactMesh& mesh, const Flanks& flanks) {
  Contact contact;
  Vec3 push = Vec3::Zero();       // the way out, geometric
  Vec3 direction = Vec3::Zero();  // the same with blended normals
  double total = 0;
  for (int j = 0; j < flanks.count; ++j) {
    const Flank& f = flanks.flank[j];
    const double weight = f.share * f.push;
    if (!(weight > 0)) continue;
    contact.points[contact.count++] = {f.at, weight};
    push += weight * f.normal;
    direction += weight * mesh.blended_normal(f.at);
    total += weight;
  }
  if (contact.count == 0) return contact;
  for (int j = 0; j < contact.count; ++j) contact.points[j].weight /= total;
  contact.depth = push.norm();
  const double length = direction.norm();
  constexpr double kCancelled = 1e-9;  // [mm] opposite flanks push alike
  contact.normal = length > kCancelled ? Vec3(direction / length) : flanks.flank[0].normal;
  return contact;
}

// The proxy on the first flank and `other`, and on a third where there is one.
Contact rest_on_others(const ContactMesh& mesh, double radius, const Vec3& center, Flanks flanks,
                       SurfacePoint other) {
  Vec3 proxy = place_proxy(center, flanks);
  for (;;) {
    flanks.flank[flanks.count++].at = other;
    proxy = settle(mesh, radius, center, proxy, flanks);
    if (flanks.count == Contact::kMost) break;
    // A third flank must indent a little: the proxy rests on the first two up to rounding only.
    constexpr double kSettled = 0.01;  // [mm]
    other = next_flank(mesh, radius, radius - kSettled, proxy, flanks);
    if (!other.found()) break;
  }
  const Contact contact = many_points(mesh, flanks);
  return contact.count > 0 ? contact : one_point(mesh, flanks.flank[0].at, flanks.flank[0].depth);
}

// A triangle below the plane through the nearest point so far, across the way to the tool, is not
// nearer: the ball about the tool only touches that plane.
bool rises(const ContactMesh& mesh, std::int32_t triangle, const Vec3& point, const Vec3& toward,
           double level) {
  const Triangle& t = mesh.triangles[triangle];
  const double a = toward.dot(mesh.points[t[0]] - point), b = toward.dot(mesh.points[t[1]] - point),
               c = toward.dot(mesh.points[t[2]] - point);
  return std::max(a, std::max(b, c)) > level;
}

}  // namespace

Beside look_beside(const ContactMesh& mesh, double radius, const Vec3& center,
                   const SurfacePoint& point) {
  Beside beside;
  const Flanks flanks = first_flank(mesh, radius, center, point, false);
  BoxTree::Rest rest = resting(radius, place_proxy(center, flanks), flanks);
  rest.center = center;
  rest.distance2 = point.distance2;
  beside.other.distance2 = radius * radius;
  const Vec3 toward = center - point.on.point;
  // [mm^2] Heights above the plane across `toward` times its length: 1e-9 mm, or some nN.
  const double level = 1e-9 * std::sqrt(point.distance2);
  mesh.tree.visit_others(rest, [&](std::int32_t triangle, bool other) {
    if (triangle == point.triangle) return beside.other.distance2;
    if (rises(mesh, triangle, point.on.point, toward, level)) {
      const SurfacePoint s = mesh.measure(triangle, center);
      if (s.distance2 < point.distance2) {
        beside = {false, s};
        return -1.0;
      }
    }
    if (other) consider(mesh, rest, triangle, beside.other);
    return beside.other.distance2;
  });
  return beside;
}

Contact rest_on_point(const ContactMesh& mesh, double radius, const SurfacePoint& point,
                      bool behind) {
  const double distance = std::sqrt(point.distance2);
  return one_point(mesh, point, behind ? radius + distance : radius - distance);
}

Contact rest_on_flanks(const ContactMesh& mesh, double radius, const Vec3& center,
                       const SurfacePoint& nearest, bool behind) {
  const Flanks one = first_flank(mesh, radius, center, nearest, behind);
  const SurfacePoint other = next_flank(mesh, radius, radius, place_proxy(center, one), one);
  return other.found() ? rest_on_others(mesh, radius, center, one, other)
                       : one_point(mesh, nearest, one.flank[0].depth);
}

Contact rest_on_two(const ContactMesh& mesh, double radius, const Vec3& center,
                    const SurfacePoint& nearest, const SurfacePoint& other) {
  return rest_on_others(mesh, radius, center, first_flank(mesh, radius, center, nearest, false),
                        other);
}

}  // namespace palpate::haptics
