// SPDX-License-Identifier: Apache-2.0
// The closed loop of hand, device and head: does it give energy, does it shake?
// For the tests and the benchmark of touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "haptics/cycle.hpp"
#include "haptics/simulated_hand.hpp"

namespace palpate::haptics::scenes {

struct PressResult {
  double work = 0;     // [N mm] done on the hand in all; negative when the hand had to give
  double given = 0;    // [N mm] most that a contact had given by any moment since it began
  double tremor = 0;   // [N] largest standard deviation over half a second of rest
  double contact = 0;  // [-] share of the time
  double force = 0;    // [N] largest
  std::size_t rests = 0;
};

/// As stiff as the device can: the map's own forces without scaling, slopes cut at its limit.
inline TickOptions stiffest() {
  TickOptions o;
  o.scaling = Scaling::none;
  return o;
}
/// The same without friction, drag and rate: nothing but the controller takes energy out.
inline TickOptions bare() {
  TickOptions o = stiffest();
  o.static_friction = o.kinetic_friction = 0;
  o.viscous = 0;
  o.rate = 0;
  return o;
}

/// Tells when the path stands still for its last half second.
class Rest {
 public:
  explicit Rest(const std::vector<Waypoint>& path) {
    for (std::size_t w = 1; w < path.size(); ++w)
      if (path[w].position == path[w - 1].position) ends_.push_back(path[w].time);
    first_ = path.front().time;
    length_ = path.back().time - first_;
  }
  [[nodiscard]] bool at(double time) const {
    const double t = first_ + std::fmod(time - first_, length_);
    return std::any_of(ends_.begin(), ends_.end(),
                       [&](double end) { return end - 0.5 < t && t < end; });
  }

 private:
  std::vector<double> ends_;
  double first_ = 0, length_ = 1;
};

inline double deviation(const std::vector<Vec3>& forces) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& f : forces) mean += f / static_cast<double>(forces.size());
  double variance = 0;
  for (const Vec3& f : forces)
    variance += (f - mean).squaredNorm() / static_cast<double>(forces.size());
  return std::sqrt(variance);
}

/// Repeats the path for `seconds` of simulated time at 1 kHz.
/// The simulated hand reports positions as coarse as the device's.
inline PressResult press(const TouchModel& model, const DeviceLimits& device,
                         const TickOptions& options, const std::vector<Waypoint>& path,
                         double seconds) {
  const TickSetup setup = make_tick_setup(model, device, options);
  SimulatedHandOptions o;
  o.limits = device;
  o.repeat = true;
  o.resolution = device.resolution;
  SimulatedHand hand(path, o);
  TouchCycle cycle(setup, hand, Workspace{});
  const Rest rest(path);
  PressResult result;
  std::vector<Vec3> resting;
  std::size_t touching = 0;
  double begun = 0;  // [N mm] work when this contact began
  bool contact = false;
  const auto ticks = static_cast<std::size_t>(1000 * seconds);
  for (std::size_t i = 0; i < ticks; ++i) {
    cycle.advance(1 + static_cast<std::int64_t>(i + 1) * 1'000'000, 0);
    const TickOutput out = cycle.latest().out;
    if (out.in_contact && !contact) begun = hand.work();
    contact = out.in_contact;
    result.given = std::max(result.given, hand.work() - begun);
    touching += out.in_contact;
    result.force = std::max(result.force, out.force.norm());
    if (rest.at(hand.time())) {
      resting.push_back(out.force);
      if (resting.size() < 480) continue;
      result.tremor = std::max(result.tremor, deviation(resting));
      ++result.rests;
    }
    resting.clear();
  }
  result.work = hand.work();
  result.contact = static_cast<double>(touching) / static_cast<double>(ticks);
  return result;
}

/// A press on one region as hard as the device allows, up to 4 N.
inline std::vector<Waypoint> press_path(const TouchModel& model, SkinRegion region,
                                        const DeviceLimits& device) {
  return region_press(model, region, std::min(4.0, 0.8 * device.peak_force),
                      SimulatedHandOptions{}.stiffness);
}

}  // namespace palpate::haptics::scenes
