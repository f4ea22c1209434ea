// SPDX-License-Identifier: Apache-2.0
// Energy is counted as the device sees it: it holds the force of tick k until tick k+1, so the work
// done on the hand is F_k . (x_(k+1) - x_k), without error. Sources:
//   Hannaford & Ryu 2002, "Time-domain passivity control of haptic interfaces"
//   Hunt & Crossley 1975, "Coefficient of restitution interpreted as damping in vibroimpact"
//   Hayward & Armstrong 2000, "A new computational model of friction applied to haptic rendering"
#include "haptics/tick.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace palpate::haptics {

namespace {

constexpr double kShortestTick = 1e-4;  // [s] a clock that stands still must not divide by 0
constexpr double kLongestTick = 1e-2;   // [s] later than that the loop has given up already

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

struct Push {
  CurveValue map;     // as mapped
  CurveValue device;  // as rendered
  double friction = 1;
};

// Every contact point's triangle answers at the same depth; weights of the points sum to 1.
Push push_of(const TickSetup& setup, const Contact& contact) {
  const TouchModel& model = *setup.model;
  Push push;
  push.friction = 0;
  const auto add = [](CurveValue& sum, const CurveValue& v, double w) {
    sum.force += w * v.force;
    sum.stiffness += w * v.stiffness;
    sum.energy += w * v.energy;
  };
  for (int j = 0; j < contact.count; ++j) {
    const ContactPoint& p = contact.points[j];
    const Triangle& corners = model.mesh.triangles[p.at.triangle];
    const Vec3& b = p.at.on.barycentric;
    if (setup.reshaped) {
      add(push.map, model.curves.blend_force(corners, b, contact.depth), p.weight);
      add(push.device, setup.curves.blend(corners, b, contact.depth), p.weight);
    } else {
      add(push.map, model.curves.blend(corners, b, contact.depth), p.weight);
    }
    for (int k = 0; k < 3; ++k)
      push.friction += p.weight * p.at.on.barycentric[k] *
                       (model.friction.empty() ? 1.0 : model.friction[corners[k]]);
  }
  if (!setup.reshaped)
    push.device = {setup.scale * push.map.force, setup.scale * push.map.stiffness,
                   setup.scale * push.map.energy};
  return push;
}

// The position that is felt, for a device whose report has steps. At rest the report jumps between
// two counts, the force with it, and a stiff contact shakes the hand for ever: only a device with
// friction of its own above half a step's change of force comes to rest on it. Near the mean of the
// last tenth of a second the way is therefore felt at a tenth, so that a step is felt at a tenth;
// farther away, where the hand moves on purpose, as reported and without lag. A low pass would lag
// in motion, and a dead band that is dragged along lags by its width: both give energy.
Vec3 felt_position(const Vec3& reported, double resolution, double dt, Vec3& mean) {
  // [s] Longer comes to the map's force later and lags more when it does; shorter follows the
  // steps.
  constexpr double kMemory = 0.12;
  constexpr double kFine = 0.1;  // [-] felt share of a step; smaller creeps longer under the hand
  // In steps from the mean: up to the first, which holds a step on all three axes, the fine share;
  // from the second on everything. Closer together they make the way between steeper than the skin.
  constexpr double kNear = 2, kFar = 12;
  mean += (1 - std::exp(-dt / kMemory)) * (reported - mean);
  if (!(resolution > 0)) return reported;
  const Vec3 away = reported - mean;
  const double coarse = smooth_step(kNear, kFar, away.norm() / resolution);
  return mean + (kFine + (1 - kFine) * coarse) * away;
}

void update_velocity(const TickOptions& options, const TickInput& input, const Vec3& moved,
                     double dt, TickState& state) {
  const Vec3 raw = input.has_velocity ? input.velocity : Vec3(moved / dt);
  const double pass = 1 - std::exp(-2 * std::numbers::pi * options.velocity_cutoff * dt);
  state.velocity = state.started ? Vec3(state.velocity + pass * (raw - state.velocity))
                                 : (input.has_velocity ? input.velocity : Vec3::Zero());
}

// The anchor sticks to the skin and is dragged when the shear force passes the friction cone. The
// coefficient falls from static to kinetic over a slipped distance and heals while sticking, so the
// force never steps.
Vec3 friction_force(const TickSetup& setup, const Push& push, double normal_force,
                    const Vec3& normal, const Vec3& moved, double dt, TickState& state) {
  const TickOptions& o = setup.options;
  if (o.static_friction == 0) return Vec3::Zero();
  const double k = std::min(o.shear_stiffness, setup.limits.stiffness);
  state.shear += moved;
  state.shear -= normal * normal.dot(state.shear);
  const double mu =
      push.friction * (o.static_friction - (o.static_friction - o.kinetic_friction) * state.slip);
  const double longest = mu * normal_force / k;
  const double length = state.shear.norm();
  constexpr double kHealing = 0.1;  // [s] rest after which static friction is back
  if (length > longest) {
    const double slipped = length - longest;
    state.shear *= longest / length;
    state.slip = std::min(1.0, state.slip + slipped / o.slip_distance);
  } else {
    state.slip *= std::exp(-dt / kHealing);
  }
  return -k * state.shear;
}

// The device's curve at one place and depth.
CurveValue rendered(const TickSetup& setup, const Triangle& corners, const Vec3& weights,
                    double depth) {
  if (setup.reshaped) return setup.curves.blend_force(corners, weights, depth);
  CurveValue v = setup.model->curves.blend_force(corners, weights, depth);
  v.force *= setup.scale;
  v.stiffness *= setup.scale;
  return v;
}

// `from` turned towards `to` by at most `step` [rad], but never left behind by more than kMostLag,
// so that the push always helps out of the skin.
Vec3 turned(const Vec3& from, const Vec3& to, double step) {
  constexpr double kMostLag = std::numbers::pi / 3;
  const double cosine = from.dot(to);
  if (cosine >= 1 - 0.5 * step * step) return to;
  const Vec3 across = from.cross(to);
  const double angle = std::atan2(across.norm(), cosine);
  step = std::max(step, angle - kMostLag);
  const Vec3 level = to - cosine * from;  // in the plane of both, square to `from`
  constexpr double kOpposite = 1e-6;
  const Vec3 side = level.norm() > kOpposite ? Vec3(level.normalized()) : from.unitOrthogonal();
  return std::cos(step) * from + std::sin(step) * side;
}

// Where a crease hands the tool from flank to flank, the contact jumps within a tick, and over a
// rim it turns faster than a hand can tell from a knock. The push goes over to the new contact: it
// turns by at most kTurn and changes by no more than the map itself along this step plus kDrift. On
// smooth skin this changes nothing, to the last bit.
void settle(const TickSetup& setup, Contact& contact, const Vec3& moved, double dt, Push& push,
            TickState& state, TickOutput& out) {
  constexpr double kTurn = 1500 * std::numbers::pi / 180;  // [rad/s] 1.5 degrees a millisecond
  constexpr double kDrift = 40;  // [N/s] 0.04 N a millisecond: below what a fingertip tells
  const ContactPoint& p = contact.points[0];
  const Triangle& corners = setup.model->mesh.triangles[p.at.triangle];
  const Vec3& weights = p.at.on.barycentric;
  Settled& s = state.settled;
  CurveValue& value = push.device;
  if (state.in_contact) {
    const Vec3 normal = turned(s.normal, contact.normal, kTurn * dt);
    const double change = value.force - s.force;
    double most = kDrift * dt + std::max(s.stiffness, value.stiffness) *
                                    std::min(std::abs(contact.depth - s.depth), moved.norm());
    if (std::abs(change) > most)
      most += std::abs(rendered(setup, corners, weights, contact.depth).force -
                       rendered(setup, s.corners, s.weights, contact.depth).force);
    out.settling = std::abs(change) > most || normal != contact.normal;
    if (std::abs(change) > most) value.force = s.force + std::copysign(most, change);
    contact.normal = normal;
  }
  s = {contact.normal, value.force, contact.depth, value.stiffness, corners, weights};
}

// Elastic push with the rate factor, viscous drag and friction; before any limit.
Vec3 contact_force(const TickSetup& setup, const Contact& contact, const Push& push,
                   const Vec3& moved, double dt, TickState& state) {
  const TickOptions& o = setup.options;
  const double indenting = -state.velocity.dot(contact.normal);
  const double elastic = push.device.force;
  // The factor never pulls and never more than doubles; its damping stays within the device's.
  constexpr double kMostFactor = 2;
  const double most_damping = setup.limits.damping;
  double rate_force = elastic * std::clamp(o.rate * indenting, -1.0, kMostFactor - 1);
  const double most = most_damping * std::abs(indenting);
  rate_force = std::clamp(rate_force, -most, most);
  const double normal_force = elastic + rate_force;
  // Drag fades in with the push, so that first contact does not step.
  constexpr double kFullDrag = 0.2;  // [N]
  const double drag = std::min(o.viscous, most_damping) * std::min(1.0, elastic / kFullDrag);
  return normal_force * contact.normal - drag * state.velocity +
         friction_force(setup, push, normal_force, contact.normal, moved, dt, state);
}

bool clamp_length(Vec3& v, double longest) {
  const double length = v.norm();
  if (!(length > longest)) return false;
  v *= longest / length;
  return true;
}

// Takes the part of the force that would give the hand more energy than the contact holds, judged
// by the last step's motion; an overdraft is paid back with damping within the device's means.
void keep_passive(const TickSetup& setup, const Vec3& moved, double dt, Vec3& force,
                  TickState& state, TickOutput& out) {
  const double moved2 = moved.squaredNorm();
  constexpr double kAtRest = 1e-12;  // [mm^2] no direction to damp along
  if (!setup.options.passivity || moved2 < kAtRest) return;
  const double given = force.dot(moved);
  const double held = std::max(state.balance, 0.0);
  double take = std::max(given - held, 0.0) / moved2;
  if (state.balance < 0) take += std::min(-state.balance / moved2, setup.limits.damping / dt);
  if (!(take > 0)) return;
  const Vec3 before = force;
  force -= take * moved;
  clamp_length(force, setup.limits.peak_force);
  out.damped = (force - before).norm();
  state.removed += (before - force).dot(moved);
}

void count_energy(const TickSetup& setup, const Vec3& moved, double stored, TickState& state) {
  const double taken = -state.force.dot(moved);
  state.balance += taken;
  state.balance = std::min(state.balance, stored + setup.options.passivity_margin);
  if (state.balance < state.generated) state.generated = state.balance;
}

void fresh_start(TickState& state) {
  state.proxy = {};
  state.force.setZero();
  state.asked.setZero();
  state.shear.setZero();
  state.velocity.setZero();
  state.slip = 0;
  state.ramp = 1;
  state.balance = std::min(state.balance, 0.0);
  state.started = false;
  state.in_contact = false;
}

void describe(const TickSetup& setup, const Contact& contact, const Push& push, TickOutput& out) {
  const TouchModel& model = *setup.model;
  const SurfacePoint& at = contact.points[0].at;
  out.in_contact = true;
  out.normal = contact.normal;
  out.point = at.on.point;
  out.depth = contact.depth;
  out.map_force = push.map.force;
  out.stiffness = push.map.stiffness;
  out.elastic = push.device.force;
  out.weights = at.on.barycentric;
  out.region = model.region_at(at);
  const Triangle& corners = model.mesh.triangles[at.triangle];
  for (int k = 0; k < 3; ++k) {
    out.vertices[k] = model.mesh.source_vertex[corners[k]];
    out.estimated = out.estimated || model.estimated[corners[k]] != 0;
  }
}

// A contact that begins deep was not worked for: it starts soft, and what it stores is granted.
void begin_contact(const TickSetup& setup, const Contact& contact, const Push& push,
                   TickState& state) {
  state.shear.setZero();
  state.slip = 0;
  const bool soft = contact.from_inside && setup.options.soft_start > 0;
  state.ramp = soft ? 0 : 1;
  if (contact.from_inside) state.balance += push.device.energy;
}

void end_contact(TickState& state) {
  state.shear.setZero();
  state.slip = 0;
  state.ramp = 1;
  state.balance = std::min(state.balance, 0.0);  // a debt stays, a credit does not
}

}  // namespace

TickOutput tick(const TickSetup& setup, const TickInput& input, TickState& state) noexcept {
  TickOutput out;
  ++state.ticks;
  out.finite = input.position.allFinite() && std::isfinite(input.dt) &&
               (!input.has_velocity || input.velocity.allFinite());
  if (!out.finite || input.hold) {
    fresh_start(state);
    if (out.finite) state.position = input.position;
    return out;
  }
  const double dt = std::clamp(input.dt, kShortestTick, kLongestTick);
  // Energy is counted along the reported way, the contact is felt along the felt one.
  const Vec3 reported = state.started ? Vec3(input.position - state.position) : Vec3::Zero();
  if (!state.started) state.mean = input.position;
  const Vec3 tool = felt_position(input.position, setup.limits.resolution, dt, state.mean);
  const Vec3 moved = state.started ? Vec3(tool - state.tool) : Vec3::Zero();
  update_velocity(setup.options, input, moved, dt, state);

  const TouchModel& model = *setup.model;
  Contact contact = find_contact(model.mesh, model.tool_radius, tool, state.proxy);
  Vec3 force = Vec3::Zero();
  double stored = 0;
  if (contact.count > 0) {
    Push push = push_of(setup, contact);
    stored = push.device.energy;
    settle(setup, contact, moved, dt, push, state, out);
    describe(setup, contact, push, out);
    if (!state.in_contact) begin_contact(setup, contact, push, state);
    force = contact_force(setup, contact, push, moved, dt, state);
    force *= state.ramp;
    if (state.ramp < 1) state.ramp = std::min(1.0, state.ramp + dt / setup.options.soft_start);
  }
  count_energy(setup, reported, stored, state);
  out.clamped = clamp_length(force, setup.limits.peak_force);
  // From what was asked for, not from what the controller left of it: it must not turn the push.
  Vec3 change = force - state.asked;
  out.slewed = clamp_length(change, setup.options.slew * dt);
  if (out.slewed) force = state.asked + change;
  state.asked = force;
  if (contact.count > 0) keep_passive(setup, reported, dt, force, state, out);
  if (contact.count == 0 && state.in_contact) end_contact(state);

  state.in_contact = contact.count > 0;
  state.position = input.position;
  state.tool = tool;
  state.force = force;
  state.started = true;
  out.force = force;
  return out;
}

namespace {

void need(bool holds, const char* name, double value, const char* range) {
  if (!holds) throw InputError(fmt::format("{} is {}; it must be {}", name, value, range));
}

}  // namespace

TickSetup make_tick_setup(const TouchModel& model, const DeviceLimits& limits,
                          const TickOptions& options) {
  const TickOptions& o = options;
  need(o.static_friction >= 0 && o.static_friction <= 2, "static friction", o.static_friction,
       "from 0 to 2");
  need(o.kinetic_friction >= 0 && o.kinetic_friction <= o.static_friction, "kinetic friction",
       o.kinetic_friction, "from 0 to the static friction");
  need(o.shear_stiffness > 0, "shear stiffness", o.shear_stiffness, "above 0 N/mm");
  need(o.slip_distance > 0, "slip distance", o.slip_distance, "above 0 mm");
  need(o.viscous >= 0 && o.viscous <= 1, "viscous damping", o.viscous, "from 0 to 1 N s/mm");
  need(o.rate >= 0 && o.rate <= 1, "rate factor", o.rate, "from 0 to 1 s/mm");
  need(o.velocity_cutoff > 0, "velocity cut-off", o.velocity_cutoff, "above 0 Hz");
  need(o.slew > 0, "slew limit", o.slew, "above 0 N/s");
  need(o.soft_start >= 0 && o.soft_start <= 10, "soft start", o.soft_start, "from 0 to 10 s");
  need(o.passivity_margin >= 0, "passivity margin", o.passivity_margin, "at least 0 N mm");
  need(limits.peak_force > 0, "the device's peak force", limits.peak_force, "above 0 N");
  need(limits.stiffness > 0, "the device's stiffness", limits.stiffness, "above 0 N/mm");
  need(limits.damping >= 0, "the device's damping", limits.damping, "at least 0 N s/mm");
  need(limits.resolution >= 0 && limits.resolution <= 1, "the device's resolution",
       limits.resolution, "from 0 to 1 mm");

  TickSetup setup;
  setup.model = &model;
  setup.options = options;
  setup.limits = limits;
  setup.scale = options.scaling == Scaling::ratio ? force_scale(model, limits) : 1;
  setup.reshaped = exceeds(model.curves, setup.scale, limits.stiffness);
  if (setup.reshaped) setup.curves = limited(model.curves, setup.scale, limits.stiffness);
  if (setup.scale < 1)
    setup.warnings.push_back(
        fmt::format("{} is weaker than the tissue: all forces are scaled by {:.3f}; regions keep "
                    "their ratios",
                    limits.name, setup.scale));
  if (setup.reshaped)
    setup.warnings.push_back(fmt::format("curves steeper than {} N/mm are flattened for {}",
                                         limits.stiffness, limits.name));
  return setup;
}

}  // namespace palpate::haptics
