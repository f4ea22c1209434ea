// SPDX-License-Identifier: Apache-2.0
// Limit cases of the two-flank solution, depth d against both, cos = n1 . n2:
//   cos -> 1 (one plane)   lambda = d / (1 + cos) each, push d along n
//   cos = 0 (right angle)  lambda = d each, push sqrt(2) d along the bisector
//   cos -> -1 (slot)       lambda = d each, pushes cancel
#include "haptics/crease.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {

namespace {

const double kCreaseCosine = std::cos(kCreaseAngle);

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

// Nearest point to `proxy` within the radius that belongs to none of the flanks so far.
SurfacePoint next_flank(const ContactMesh& mesh, double radius, const Vec3& proxy,
                        const Flanks& flanks) {
  // Points of one sphere closer than this are seen under less than kCreaseAngle.
  const double apart = 2 * radius * std::sin(0.5 * kCreaseAngle);
  BoxTree::Except taken;
  taken.count = flanks.count;
  taken.radius = apart;
  for (int j = 0; j < flanks.count; ++j) taken.centers[j] = flanks.flank[j].at.on.point;
  SurfacePoint best;
  best.distance2 = radius * radius;
  const auto visit = [&](std::int32_t triangle) {
    const SurfacePoint s = mesh.measure(triangle, proxy);
    if (s.distance2 > best.distance2 || (s.distance2 == best.distance2 && triangle > best.triangle))
      return best.distance2;
    for (int j = 0; j < flanks.count; ++j)
      if ((s.on.point - taken.centers[j]).squaredNorm() < apart * apart) return best.distance2;
    if (mesh.side_normal(s).dot(proxy - s.on.point) > 0) best = s;
    return best.distance2;
  };
  mesh.tree.visit_near(proxy, best.distance2, taken, visit);
  return best;
}

// Projected Gauss-Seidel; a fixed number of sweeps keeps the result a continuous function.
void share_push(Flanks& flanks) {
  constexpr int kSweeps = 40;  // cos(20 deg)^80 = 0.7 %: the slowest pair that counts in full
  for (int j = 0; j < flanks.count; ++j) flanks.flank[j].push = 0;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int j = 0; j < flanks.count; ++j) {
      Flank& a = flanks.flank[j];
      double rest = a.depth;
      for (int k = 0; k < flanks.count; ++k) {
        if (k == j) continue;
        const Flank& b = flanks.flank[k];
        rest -= std::max(a.normal.dot(b.normal), 0.0) * a.share * b.share * b.push;
      }
      a.push = std::max(rest, 0.0);
    }
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// How much each later flank is a contact of its own: by the angle under which the proxy sees it
// beside the earlier ones, and by the turn of the blended normal between the two, which is what
// the hand would feel as a jump. Facets of a smooth valley differ in the first, not in the second.
void find_shares(const ContactMesh& mesh, Flanks& flanks) {
  std::array<Vec3, Contact::kMost> blended;
  for (int j = 0; j < flanks.count; ++j) blended[j] = mesh.blended_normal(flanks.flank[j].at);
  for (int j = 1; j < flanks.count; ++j) {
    double seen = 4;
    double turn = 4;
    for (int k = 0; k < j; ++k) {
      seen = std::min(seen, angle_between(flanks.flank[j].normal, flanks.flank[k].normal));
      turn = std::min(turn, angle_between(blended[j], blended[k]));
    }
    flanks.flank[j].share = smooth_step(kCreaseAngle, 2 * kCreaseAngle, seen) *
                            smooth_step(0.5 * kCreaseAngle, 1.5 * kCreaseAngle, turn);
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

// Newton's steps towards the proxy that rests on all flanks; they bend little within a step.
Vec3 settle(const ContactMesh& mesh, double radius, const Vec3& center, Vec3 proxy,
            Flanks& flanks) {
  constexpr int kSteps = 4;
  for (int step = 0; step < kSteps; ++step) {
    for (int j = 0; j < flanks.count; ++j) {
      flanks.flank[j].at = mesh.descend(proxy, flanks.flank[j].at);
      measure_flank(mesh, radius, center, proxy, flanks.flank[j]);
    }
    find_shares(mesh, flanks);
    share_push(flanks);
    proxy = place_proxy(center, flanks);
  }
  return proxy;
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

}  // namespace

bool rests_alone(const ContactMesh& mesh, double radius, const Vec3& center,
                 const SurfacePoint& point) {
  BoxTree::Rest rest;
  rest.center = center;
  rest.distance2 = point.distance2;
  rest.normal = outward(mesh, point, center, false);
  rest.proxy = center + (radius - std::sqrt(point.distance2)) * rest.normal;
  rest.radius = radius;
  rest.point = point.on.point;
  rest.apart = 2 * radius * std::sin(0.5 * kCreaseAngle);
  rest.cosine = kCreaseCosine;
  return mesh.tree.confirm_rest(rest, [&](std::int32_t triangle) {
    if (mesh.measure(triangle, center).distance2 < point.distance2) return true;
    const SurfacePoint s = mesh.measure(triangle, rest.proxy);
    return s.distance2 < radius * radius &&
           (s.on.point - rest.point).squaredNorm() >= rest.apart * rest.apart &&
           mesh.side_normal(s).dot(rest.proxy - s.on.point) > 0;
  });
}

Contact rest_on_point(const ContactMesh& mesh, double radius, const SurfacePoint& point,
                      bool behind) {
  const double distance = std::sqrt(point.distance2);
  return one_point(mesh, point, behind ? radius + distance : radius - distance);
}

Contact rest_on_flanks(const ContactMesh& mesh, double radius, const Vec3& center,
                       const SurfacePoint& nearest, bool behind) {
  const double distance = std::sqrt(nearest.distance2);
  const double depth = behind ? radius + distance : radius - distance;
  Flanks flanks;
  flanks.count = 1;
  flanks.flank[0].at = nearest;
  flanks.flank[0].normal = outward(mesh, nearest, center, behind);
  flanks.flank[0].depth = depth;
  flanks.flank[0].push = depth;
  Vec3 proxy = place_proxy(center, flanks);

  while (flanks.count < Contact::kMost) {
    // A third flank must indent a little: the proxy rests on the first two up to rounding only.
    constexpr double kSettled = 0.01;  // [mm]
    const double reach = flanks.count == 1 ? radius : radius - kSettled;
    const SurfacePoint found = next_flank(mesh, reach, proxy, flanks);
    if (!found.found()) break;
    flanks.flank[flanks.count++].at = found;
    proxy = settle(mesh, radius, center, proxy, flanks);
  }
  if (flanks.count == 1) return one_point(mesh, nearest, depth);
  const Contact contact = many_points(mesh, flanks);
  return contact.count > 0 ? contact : one_point(mesh, nearest, depth);
}

}  // namespace palpate::haptics
