// SPDX-License-Identifier: Apache-2.0
// A tool that slides over a whole head at one speed and depth: where does the force jump?
// For the tests and the benchmark of touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "haptics/tick.hpp"

namespace palpate::haptics::scenes {

struct SlideOptions {
  double step = 0.1;      // [mm] a tick: 100 mm/s at 1 kHz
  double depth = 3;       // [mm] that the hand keeps
  double spacing = 5;     // [mm] between the rounds of the way about the head
  double crease = 0.698;  // [rad] 40 degrees: skin whose normals turn by more within one tool
                          // radius of the touched point is a crease or a rim
};

struct SlideResult {
  std::size_t ticks = 0;     // in contact, followed by another in contact
  std::size_t smooth = 0;    // of them on skin without creases
  std::size_t lifts = 0;     // times the tool came off (a rim, the open neck)
  double excess = 0;         // [N] largest change of the force beyond the map's own
  double change = 0;         // [N] largest change of its size in a tick
  double depth_jump = 0;     // [mm] largest change of the depth in a tick
  double turn_smooth = 0;    // [deg] largest change of direction in a tick, without creases
  double turn_anywhere = 0;  // [deg]
  std::size_t turns = 0;     // ticks without creases that turn by more than 2 degrees
  std::size_t settling = 0;  // ticks in which the push goes over from one flank to another
  Vec3 worst_excess = Vec3::Zero(), worst_turn = Vec3::Zero();  // [mm] where
};

/// Forces as mapped, nothing else: no friction, damping, limits or controller.
inline TickOptions elastic_only() {
  TickOptions o;
  o.scaling = Scaling::none;
  o.static_friction = o.kinetic_friction = 0;
  o.viscous = 0;
  o.rate = 0;
  o.slew = 1e9;
  o.soft_start = 0;
  o.passivity = false;
  return o;
}

/// Directions from pole to pole, `spacing` mm apart on a sphere of 100 mm.
inline std::vector<Vec3> spiral_directions(double spacing) {
  std::vector<Vec3> directions;
  const double rounds = 0.5 * std::numbers::pi * 100 * 2 / spacing;
  const double step = spacing / 100;  // [rad]
  double azimuth = 0;
  for (double polar = 0.02; polar < std::numbers::pi - 0.02;) {
    directions.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                            std::sin(polar) * std::sin(azimuth));
    const double turn = step / std::sin(polar);
    azimuth += turn;
    polar += std::numbers::pi / rounds * turn / (2 * std::numbers::pi);
  }
  return directions;
}

/// Per point of the mesh: the largest angle [rad] between its normal and one within `reach` mm,
/// going along edges.
inline std::vector<float> normal_spread(const ContactMesh& mesh, double reach) {
  std::vector<float> spread(mesh.points.size(), 0);
  std::vector<std::int32_t> seen(mesh.points.size(), -1), queue;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    queue.assign(1, static_cast<std::int32_t>(v));
    seen[v] = static_cast<std::int32_t>(v);
    double cosine = 1;
    for (std::size_t head = 0; head < queue.size(); ++head) {
      const std::int32_t p = queue[head];
      cosine = std::min(cosine, mesh.normals[v].dot(mesh.normals[p]));
      for (std::int32_t i = mesh.ring_begin[p]; i < mesh.ring_begin[p + 1]; ++i)
        for (const std::int32_t q : mesh.triangles[mesh.ring[i]]) {
          if (seen[q] == static_cast<std::int32_t>(v) ||
              (mesh.points[q] - mesh.points[v]).squaredNorm() > reach * reach)
            continue;
          seen[q] = static_cast<std::int32_t>(v);
          queue.push_back(q);
        }
    }
    spread[v] = static_cast<float>(std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  return spread;
}

/// What one tick to the next says; kept apart so that a caller may feed it any path.
class SlideMeter {
 public:
  SlideMeter(const TouchModel& model, const SlideOptions& options)
      : model_(model), spread_(normal_spread(model.mesh, model.tool_radius)), options_(options) {}

  void add(const TickOutput& out, const Vec3& at, const TickState& state) {
    if (state.ticks > 1 && previous_.in_contact && out.in_contact) compare(out, at);
    previous_ = out;
    previous_at_ = at;
  }
  SlideResult result;

 private:
  [[nodiscard]] Triangle corners(const TickOutput& touched) const {
    Triangle t;
    for (int k = 0; k < 3; ++k)
      t[k] = model_.mesh.vertex_of[static_cast<std::size_t>(touched.vertices[k])];
    return t;
  }
  [[nodiscard]] double mapped(const TickOutput& touched, double depth) const {
    return model_.curves.blend(corners(touched), touched.weights, depth).force;
  }
  [[nodiscard]] bool creased(const TickOutput& touched) const {
    const Triangle t = corners(touched);
    return std::any_of(t.begin(), t.end(), [&](std::int32_t v) {
      return spread_[static_cast<std::size_t>(v)] > options_.crease;
    });
  }
  // The map's own change: from the touched point before to the one after at one depth, and along
  // the curve by no more depth than the tool moved.
  void compare(const TickOutput& out, const Vec3& at) {
    const double moved = (at - previous_at_).norm();
    const double change = std::abs(out.force.norm() - previous_.force.norm());
    const double deeper = std::abs(out.depth - previous_.depth);
    const double own = std::abs(mapped(out, out.depth) - mapped(previous_, out.depth)) +
                       std::max(out.stiffness, previous_.stiffness) * std::min(deeper, moved);
    SlideResult& r = result;
    ++r.ticks;
    r.settling += out.settling;
    r.change = std::max(r.change, change);
    r.depth_jump = std::max(r.depth_jump, deeper - moved);
    if (change - own > r.excess) {
      r.excess = change - own;
      r.worst_excess = out.point;
    }
    constexpr double kDegrees = 180 / std::numbers::pi;
    const double turn = kDegrees * std::atan2(out.force.cross(previous_.force).norm(),
                                              out.force.dot(previous_.force));
    r.turn_anywhere = std::max(r.turn_anywhere, turn);
    if (creased(out) || creased(previous_)) return;
    ++r.smooth;
    r.turns += turn > 2;
    if (turn > r.turn_smooth) {
      r.turn_smooth = turn;
      r.worst_turn = out.point;
    }
  }

  const TouchModel& model_;
  std::vector<float> spread_;
  SlideOptions options_;
  TickOutput previous_;
  Vec3 previous_at_ = Vec3::Zero();
};

/// Goes about the head from crown to neck: towards the next target along the skin, and towards the
/// wanted depth along the normal, `step` mm a tick in all. A tool that came off starts again above
/// the next target, with a fresh state.
/// @param visit  called after each tick with its output, input and state
/// @returns how often the tool had to start again
template <class Visit>
std::size_t walk_over_head(const TickSetup& setup, const SlideOptions& options, Visit&& visit) {
  const TouchModel& model = *setup.model;
  const Box box = model.mesh.tree.box();
  const double outer = box.size().norm();
  constexpr int kPatience = 100;  // ticks without contact
  TickState state;
  TickInput input;
  TickOutput out;
  int lost = kPatience + 1;
  std::size_t starts = 0;
  for (const Vec3& d : spiral_directions(options.spacing)) {
    const SurfacePoint goal = model.mesh.nearest(box.center() + outer * d, 1e300);
    const Vec3 n = model.mesh.blended_normal(goal);
    const Vec3 target = goal.on.point + (model.tool_radius - options.depth) * n;
    if (lost > kPatience) {
      input.position = goal.on.point + (model.tool_radius + 0.5) * n;
      state = {};
      out = {};
      lost = 0;
      ++starts;
    }
    const int most = static_cast<int>(4 * options.spacing / options.step);
    for (int i = 0; i < most && (target - input.position).norm() > options.step; ++i) {
      Vec3 way = target - input.position;
      if (out.in_contact) {
        way -= out.normal * out.normal.dot(way);
        if (way.norm() > 1) way.normalize();
        way += (out.depth - options.depth) * out.normal;
      }
      const double length = way.norm();
      if (length < 1e-3) break;
      input.position += way * std::min(1.0, options.step / length);
      out = tick(setup, input, state);
      visit(out, input, state);
      lost = out.in_contact ? 0 : lost + 1;
    }
  }
  return starts;
}

inline SlideResult slide_over_head(const TouchModel& model, const SlideOptions& options = {}) {
  const TickSetup setup = make_tick_setup(model, unlimited(), elastic_only());
  SlideMeter meter(model, options);
  const std::size_t starts = walk_over_head(
      setup, options, [&](const TickOutput& out, const TickInput& input, const TickState& state) {
        meter.add(out, input.position, state);
      });
  meter.result.lifts = starts - 1;
  return meter.result;
}

}  // namespace palpate::haptics::scenes
