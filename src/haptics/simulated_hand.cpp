// SPDX-License-Identifier: Apache-2.0
#include "haptics/simulated_hand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/error.hpp"

namespace palpate::haptics {

namespace {

constexpr int kSubsteps = 10;  // of a period; 0.1 ms at 1 kHz

void check(const std::vector<Waypoint>& path, const SimulatedHandOptions& o) {
  if (path.empty()) throw InputError("the simulated hand has no path");
  for (std::size_t i = 1; i < path.size(); ++i)
    if (!(path[i].time > path[i - 1].time))
      throw InputError(
          fmt::format("waypoint {} of the simulated hand is not later than the one "
                      "before it",
                      i));
  if (!(o.rate_hz > 0 && o.mass > 0 && o.stiffness >= 0 && o.damping >= 0 && o.resolution >= 0))
    throw InputError(
        "the simulated hand's rate, mass, stiffness, damping or resolution is negative");
}

}  // namespace

SimulatedHand::SimulatedHand(std::vector<Waypoint> path, const SimulatedHandOptions& options)
    : path_(std::move(path)), options_(options) {
  check(path_, options_);
  position_ = path_.front().position;
  time_ = path_.front().time;
  info_.backend = "simulated";
  info_.name = "simulated hand";
  info_.limits = options_.limits;
}

Vec3 SimulatedHand::target(double time) const noexcept {
  const double first = path_.front().time;
  const double length = path_.back().time - first;
  if (options_.repeat && length > 0) time = first + std::fmod(time - first, length);
  if (time >= path_.back().time) return path_.back().position;
  const auto next = std::upper_bound(path_.begin(), path_.end(), time,
                                     [](double t, const Waypoint& w) { return t < w.time; });
  if (next == path_.begin()) return path_.front().position;
  const Waypoint& a = *(next - 1);
  const Waypoint& b = *next;
  const double t = (time - a.time) / (b.time - a.time);
  return a.position + t * t * (3 - 2 * t) * (b.position - a.position);
}

bool SimulatedHand::finished() const {
  return !options_.repeat && time_ >= path_.back().time;
}

bool SimulatedHand::failing(HandFault::Kind kind) const noexcept {
  return std::any_of(options_.faults.begin(), options_.faults.end(), [&](const HandFault& f) {
    return f.kind == kind && time_ >= f.from && time_ < f.to;
  });
}

// Velocity first, implicit in the damper and the spring (stable for any substep), then position.
void SimulatedHand::step(double dt) noexcept {
  const Vec3 wanted = target(time_ + dt);
  const double m = options_.mass, k = options_.stiffness, b = options_.damping;
  velocity_ =
      (m * velocity_ + dt * (force_ + k * (wanted - position_))) / (m + dt * b + dt * dt * k);
  const Vec3 moved = dt * velocity_;
  work_ += force_.dot(moved);
  position_ += moved;
  time_ += dt;
}

DeviceStatus SimulatedHand::read(DeviceSample& sample) noexcept {
  const double dt = 1 / options_.rate_hz / kSubsteps;
  for (int i = 0; i < kSubsteps; ++i) step(dt);
  if (failing(HandFault::Kind::lost)) return DeviceStatus::lost;
  if (failing(HandFault::Kind::stale) && number_ > 0) return DeviceStatus::ok;
  ++number_;
  sample.number = number_;
  sample.position = position_;
  if (options_.resolution > 0)
    sample.position = options_.resolution * Vec3((position_ / options_.resolution).array().round());
  if (failing(HandFault::Kind::not_finite))
    sample.position.y() = std::numeric_limits<double>::quiet_NaN();
  sample.velocity = velocity_;
  sample.has_velocity = options_.reports_velocity;
  sample.buttons = options_.buttons;
  return DeviceStatus::ok;
}

DeviceStatus SimulatedHand::write(const Vec3& force) noexcept {
  if (failing(HandFault::Kind::lost) || failing(HandFault::Kind::refuses_force)) {
    force_.setZero();
    return failing(HandFault::Kind::lost) ? DeviceStatus::lost : DeviceStatus::ignored;
  }
  force_ = force;
  return DeviceStatus::ok;
}

void SimulatedHand::release() noexcept {
  force_.setZero();
}

namespace {

// Lays waypoints one after the other in time.
struct Route {
  const TouchModel& model;
  double deeper;  // [mm] that the hand aims below the skin so that its spring gives the force
  std::vector<Waypoint> path;
  double time = 0;

  void go(double seconds, const Vec3& p) {
    time += seconds;
    path.push_back({time, p});
  }
  // From place to place on a sphere around the head, never through it.
  void go_around(const Vec3& to) {
    const Vec3 middle = model.mesh.tree.box().center();
    const double far = 0.5 * model.mesh.tree.box().size().norm() + model.tool_radius + 20;
    const Vec3 a = (path.back().position - middle).normalized();
    const Vec3 b = (to - middle).normalized();
    constexpr int kLegs = 6;
    for (int i = 0; i <= kLegs; ++i) {
      const double t = static_cast<double>(i) / kLegs;
      Vec3 d = (1 - t) * a + t * b;
      if (d.norm() < 0.1) d = a.unitOrthogonal();  // opposite sides of the head
      go(0.3, middle + far * d.normalized());
    }
    go(0.3, to);
  }
  void press_and_slide(SkinRegion region) {
    const Workspace aim = aimed_at(model, region, DeviceInfo{});
    const Vec3 along = aim.rotation.col(0);
    const auto over = [&](double x, double height) {
      const SurfacePoint near = model.mesh.nearest(aim.at_head + x * along, 1e300);
      return Vec3(near.on.point + (model.tool_radius + height) * model.mesh.blended_normal(near));
    };
    if (path.empty())
      go(0.01, over(0, 60));
    else
      go_around(over(0, 60));
    go(1.0, over(0, 5));
    go(0.5, over(0, -deeper));
    for (const double x : {4.0, 8.0, 10.0, 6.0, 0.0, -6.0, -10.0, -4.0}) go(0.15, over(x, -deeper));
    go(0.3, over(0, -deeper));
    go(1.0, over(0, -deeper));
    go(0.5, over(0, 60));
  }
};

Route route(const TouchModel& model, double force, double hand_stiffness) {
  constexpr double kSoftest = 1e-3;  // [N/mm] a hand without a spring aims at no depth
  return {model, force / std::max(hand_stiffness, kSoftest), {}};
}

}  // namespace

std::vector<Waypoint> region_press(const TouchModel& model, SkinRegion region, double force,
                                   double hand_stiffness) {
  Route r = route(model, force, hand_stiffness);
  r.press_and_slide(region);
  return r.path;
}

std::vector<Waypoint> region_tour(const TouchModel& model, double force, double hand_stiffness) {
  Route r = route(model, force, hand_stiffness);
  for (std::size_t i = 0; i < kSkinRegionNames.size(); ++i) {
    const auto region = static_cast<SkinRegion>(i);
    if (std::find(model.region.begin(), model.region.end(), region) != model.region.end())
      r.press_and_slide(region);
  }
  if (!r.path.empty()) r.go_around(Vec3(r.path.front().position));
  return r.path;
}

std::vector<Waypoint> random_walk(const TouchModel& model, std::uint64_t seed, double seconds,
                                  double speed) {
  std::mt19937_64 rng(seed);
  // [0, 1) from the top bits: the library's distributions may differ between systems.
  const auto uniform = [&] { return static_cast<double>(rng() >> 11) * 0x1p-53; };
  const Box box = model.mesh.tree.box();
  const double outer = 0.5 * box.size().maxCoeff();
  std::vector<Waypoint> path;
  double time = 0;
  Vec3 direction = Vec3::UnitZ();
  while (time < seconds) {
    direction += 0.3 * Vec3(uniform() - 0.5, uniform() - 0.5, uniform() - 0.5);
    direction.normalize();
    const SurfacePoint near = model.mesh.nearest(box.center() + outer * direction, 1e300);
    const double height = model.tool_radius - 8 + 12 * uniform();
    const Vec3 p = near.on.point + height * model.mesh.blended_normal(near);
    const double way = path.empty() ? 0 : (p - path.back().position).norm();
    // Easing peaks at 1.5 times the mean speed.
    time += std::max(0.01, 1.5 * way / speed * (1 + uniform()));
    path.push_back({time, p});
  }
  return path;
}

}  // namespace palpate::haptics
