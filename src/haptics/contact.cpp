// SPDX-License-Identifier: Apache-2.0
#include "haptics/contact.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/crease.hpp"

namespace palpate::haptics {

namespace {

// [mm] How far beyond contact free space is searched; a tool slower than this (plus its radius) per
// tick needs no swept test.
constexpr double kLookAhead = 5;

// [mm] A tick that moves farther than this is a jump, and what lies between is looked at.
constexpr double kJump = 2;

// Its sign tells: positive in front of the skin, negative behind.
double side_of(const ContactMesh& mesh, const SurfacePoint& at, const Vec3& center) {
  return mesh.side_normal(at).dot(center - at.on.point);
}

// Follows the surface from `from` towards `to` in the plane through both and the centre. True when
// the way never gets farther from the centre than `limit2`.
bool surface_leads(const ContactMesh& mesh, const Vec3& center, const SurfacePoint& from,
                   const SurfacePoint& to, double limit2) {
  constexpr int kSteps = 64;  // triangles crossed; a 0.4 mm mesh reaches 20 mm
  const Vec3 a = from.on.point - center;
  const Vec3 b = to.on.point - center;
  if (!(a.dot(b) > 0.5 * a.norm() * b.norm())) return false;  // seen more than 60 degrees apart
  const Vec3 across = a.cross(b);
  const double smallest = 1e-18;  // [mm^4] the points coincide or lie in line
  if (!(across.squaredNorm() > smallest)) return from.triangle == to.triangle;
  const Vec3 forward = across.cross(a);  // in the plane, from a towards b
  std::int32_t t = from.triangle;
  std::int32_t came_from = -1;
  for (int step = 0; step < kSteps; ++step) {
    if (t == to.triangle) return true;
    const Triangle& corners = mesh.triangles[t];
    std::int32_t next = -1;
    double best = -1e300;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t other = mesh.neighbours[t][k];
      if (other == came_from && came_from >= 0) continue;
      const Vec3 p = mesh.points[corners[k]] - center;
      const Vec3 q = mesh.points[corners[(k + 1) % 3]] - center;
      const double hp = across.dot(p);
      const double hq = across.dot(q);
      if ((hp >= 0) == (hq >= 0)) continue;
      const Vec3 x = p + (hp / (hp - hq)) * (q - p);
      // In the first triangle the plane leaves through two edges: take the one ahead.
      const double ahead = forward.dot(x);
      if (ahead <= best) continue;
      best = ahead;
      next = x.squaredNorm() <= limit2 ? other : -1;
    }
    if (next < 0) return false;
    came_from = t;
    t = next;
  }
  return false;
}

// The proxy's next point while the centre is behind the surface at the anchor.
SurfacePoint slide_inside(const ContactMesh& mesh, const Vec3& center, const SurfacePoint& local) {
  const SurfacePoint global = mesh.nearest(center, local.distance2, local);
  if (!global.found() || !(global.distance2 < local.distance2)) return local;
  const double climb = std::sqrt(local.distance2) + kRoughness;
  return surface_leads(mesh, center, local, global, climb * climb) ? global : local;
}

// Moves a sphere from `from` towards `to` through free space and returns the surface point at which
// it stops, or nothing. Steps by the free distance (sphere tracing), at most kSteps times: a graze
// that takes longer counts as a touch.
SurfacePoint sweep(const ContactMesh& mesh, double radius, const Vec3& from, const Vec3& to) {
  constexpr int kSteps = 48;
  constexpr double kTouch = 1e-3;  // [mm] this near counts as touching
  const Vec3 way = to - from;
  const double length = way.norm();
  const Box& box = mesh.tree.box();
  double t = 0;
  double t_end = 1;
  for (int k = 0; k < 3; ++k) {  // the stretch inside the box grown by the radius
    const double low = box.low[k] - radius - 1;
    const double high = box.high[k] + radius + 1;
    if (way[k] == 0) {
      if (from[k] < low || from[k] > high) return {};
      continue;
    }
    const double t0 = (low - from[k]) / way[k];
    const double t1 = (high - from[k]) / way[k];
    t = std::max(t, std::min(t0, t1));
    t_end = std::min(t_end, std::max(t0, t1));
  }
  SurfacePoint near;
  for (int step = 0; step < kSteps && t < t_end; ++step) {
    const Vec3 at = from + t * way;
    near = mesh.nearest(at, 1e300, near.found() ? mesh.descend(at, near) : near);
    const double free = std::sqrt(near.distance2) - radius;
    if (free <= kTouch) return near;
    t += free / length;
  }
  return t < t_end ? near : SurfacePoint{};
}

enum class Side { free, front, behind };

Side touch(ProxyState& state, const SurfacePoint& at, bool behind) {
  state.anchor = at;
  state.clearance = behind ? 0 : std::sqrt(at.distance2);
  return behind ? Side::behind : Side::front;
}
Side leave(ProxyState& state, double clearance) {
  state.clearance = clearance;
  return Side::free;
}

// The first tick knows no history: what is behind the nearest point is inside the head.
Side begin(const ContactMesh& mesh, double radius, const Vec3& center, ProxyState& state) {
  const SurfacePoint near = mesh.nearest(center, 1e300);
  const bool behind = side_of(mesh, near, center) < 0;
  const double distance = std::sqrt(near.distance2);
  state.from_inside = true;
  if (behind && !mesh.on_border(near)) return touch(state, near, true);
  if (!behind && distance < radius) return touch(state, near, false);
  state.anchor = near;
  return leave(state, distance);
}

// The centre's path from the last tick may have crossed the skin: finds the first place where.
bool swept_into(const ContactMesh& mesh, double radius, const Vec3& center, ProxyState& state) {
  const SurfacePoint stop = sweep(mesh, radius, state.center, center);
  if (!stop.found() || side_of(mesh, stop, state.center) < 0) return false;
  state.anchor = mesh.descend(center, stop);
  if (side_of(mesh, state.anchor, center) < 0)
    state.anchor = slide_inside(mesh, center, state.anchor);
  return true;
}

// From free space.
Side arrive(const ContactMesh& mesh, double radius, const Vec3& center, ProxyState& state) {
  const double moved = (center - state.center).norm();
  if (moved >= state.clearance && swept_into(mesh, radius, center, state)) {
    state.from_inside = false;
    const bool behind = side_of(mesh, state.anchor, center) < 0;
    if (behind || state.anchor.distance2 < radius * radius)
      return touch(state, state.anchor, behind);
  }
  const double reach = radius + kLookAhead;
  const SurfacePoint last =
      state.anchor.found() ? mesh.descend(center, state.anchor) : SurfacePoint{};
  const SurfacePoint near = mesh.nearest(center, reach * reach, last);
  if (!near.found()) return leave(state, reach);
  state.anchor = near;
  const double distance = std::sqrt(near.distance2);
  // A back side: the tool is inside an open scan, which is not felt.
  if (distance >= radius || side_of(mesh, near, center) < 0) return leave(state, distance);
  constexpr double kRounding = 1e-6;  // [mm]
  state.from_inside = radius - distance > moved + kRounding;
  return touch(state, near, false);
}

// In contact already.
Side follow(const ContactMesh& mesh, double radius, const Vec3& center, ProxyState& state) {
  const SurfacePoint local = mesh.descend(center, state.anchor);
  if (side_of(mesh, local, center) < 0) {
    const SurfacePoint at = slide_inside(mesh, center, local);
    return touch(state, at, side_of(mesh, at, center) < 0);
  }
  const double moved = (center - state.center).norm();
  if (moved >= kJump && moved >= state.clearance && state.clearance > 0 &&
      swept_into(mesh, std::min(radius, 0.5 * state.clearance), center, state) &&
      side_of(mesh, state.anchor, center) < 0)
    return touch(state, state.anchor, true);
  const SurfacePoint global = mesh.nearest(center, local.distance2, local);
  const bool visible = global.found() && side_of(mesh, global, center) >= 0;
  const SurfacePoint& at = visible ? global : local;
  if (at.distance2 < radius * radius) return touch(state, at, false);
  state.anchor = at;
  return leave(state, std::sqrt(at.distance2));
}

// The common case, settled by a walk down the tree: in contact from outside before and after, and
// the nearest point is where the proxy slides to by itself. Where two facets of a hollow meet, the
// proxy slides to the one and the other is nearer by a hair: then it goes on from there.
bool slides_on(const ContactMesh& mesh, double radius, const Vec3& center, ProxyState& state,
               Contact& contact) {
  constexpr int kHollows =
      3;  // facets taken one after the other, before the whole surface is asked
  if (!state.touching || (center - state.center).squaredNorm() >= kJump * kJump) return false;
  SurfacePoint local = mesh.descend(center, state.anchor);
  for (int hollow = 0; hollow < kHollows; ++hollow) {
    if (local.distance2 >= radius * radius || side_of(mesh, local, center) < 0) return false;
    const Beside beside = look_beside(mesh, radius, center, local);
    if (!beside.nearest) {
      local = mesh.descend(center, beside.other);
      continue;
    }
    touch(state, local, false);
    contact = beside.other.found() ? rest_on_two(mesh, radius, center, local, beside.other)
                                   : rest_on_point(mesh, radius, local, false);
    return true;
  }
  return false;
}

}  // namespace

Contact find_contact(const ContactMesh& mesh, double radius, const Vec3& center,
                     ProxyState& state) {
  Contact contact;
  if (!slides_on(mesh, radius, center, state, contact)) {
    const Side side = !state.started   ? begin(mesh, radius, center, state)
                      : state.touching ? follow(mesh, radius, center, state)
                                       : arrive(mesh, radius, center, state);
    state.touching = side != Side::free;
    if (state.touching)
      contact = rest_on_flanks(mesh, radius, center, state.anchor, side == Side::behind);
  }
  state.started = true;
  state.center = center;
  contact.from_inside = state.touching && state.from_inside;
  return contact;
}

}  // namespace palpate::haptics
