// SPDX-License-Identifier: Apache-2.0
// The closed loop of hand, device and head: no energy from nowhere, no tremor at rest.
#include <gtest/gtest.h>

#include "haptics/cycle.hpp"
#include "haptics/simulated_hand.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

struct Outcome {
  double work = 0;       // [N mm] done on the hand
  double tremor = 0;     // [N] largest standard deviation over a rest of 0.5 s
  double generated = 0;  // [N mm] most that the controller found given back beyond what was taken
  double contact = 0;    // [-] share of the time
};

// Presses and slides on every region in turn for `seconds`, as stiff as the device allows.
Outcome tour(const TouchModel& model, const DeviceLimits& device, const TickOptions& options,
             double seconds, double resolution = 0) {
  const TickSetup setup = make_tick_setup(model, device, options);
  SimulatedHandOptions o;
  o.limits = device;
  o.repeat = true;
  o.resolution = resolution;
  const std::vector<Waypoint> path =
      region_tour(model, std::min(4.0, 0.8 * device.peak_force), o.stiffness);
  SimulatedHand hand(path, o);
  TouchCycle cycle(setup, hand, Workspace{});
  Outcome result;
  std::int64_t now = 1;
  std::vector<double> rest;
  const auto ticks = static_cast<int>(1000 * seconds);
  double contact = 0;
  for (int i = 0; i < ticks; ++i) {
    cycle.advance(now += 1'000'000, 0);
    const CycleSnapshot s = cycle.latest();
    contact += s.out.in_contact;
    result.generated = std::min(result.generated, s.balance);
    // The last half second of the second in which the path rests in contact.
    const double t =
        std::fmod(hand.time() - path.front().time, path.back().time - path.front().time) +
        path.front().time;
    bool resting = false;
    for (std::size_t w = 1; w < path.size(); ++w)
      resting = resting || (path[w].position == path[w - 1].position && path[w].time - t < 0.5 &&
                            t < path[w].time);
    if (resting)
      rest.push_back(s.out.force.norm());
    else
      rest.clear();
    if (rest.size() >= 480) {
      const double mean = std::accumulate(rest.begin(), rest.end(), 0.0) / 480;
      double variance = 0;
      for (const double f : rest) variance += (f - mean) * (f - mean) / 480;
      result.tremor = std::max(result.tremor, std::sqrt(variance));
      rest.clear();
    }
  }
  result.work = hand.work();
  result.contact = contact / ticks;
  return result;
}

// As stiff as the device can: the map's own curves without scaling, slopes cut at its limit.
TickOptions stiffest() {
  TickOptions o;
  o.scaling = Scaling::none;
  return o;
}

TEST(Passivity, EveryDeviceAtItsStiffest) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  for (const DeviceLimits& device : known_devices()) {
    const Outcome with = tour(model, device, stiffest(), 60);
    EXPECT_LT(with.work, 0.01) << device.name;
    EXPECT_LT(with.tremor, 0.02) << device.name;
    EXPECT_GT(with.contact, 0.3) << device.name;
    // Without friction, damping and rate nothing but the controller takes energy out.
    TickOptions bare = stiffest();
    bare.static_friction = bare.kinetic_friction = 0;
    bare.viscous = 0;
    bare.rate = 0;
    const Outcome without = tour(model, device, bare, 60);
    EXPECT_LT(without.work, 0.5) << device.name;
    EXPECT_LT(without.tremor, 0.02) << device.name;
    std::printf("%-26s work %8.2f N mm tremor %.4f N  bare: %8.2f, %.4f, least balance %.3f\n",
                std::string(device.name).c_str(), with.work, with.tremor, without.work,
                without.tremor, without.generated);
  }
}

TEST(Passivity, TenMinutesOnTheStiffestDevice) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  const Outcome o = tour(model, *limits_of("lambda.7"), stiffest(), 600);
  EXPECT_LT(o.work, 0.01);
  EXPECT_LT(o.tremor, 0.02);
  std::printf("10 min: work %.1f N mm, tremor %.4f N\n", o.work, o.tremor);
}

TEST(Passivity, ACoarseEncoderDoesNotShake) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  const Outcome o = tour(model, *limits_of("falcon"), stiffest(), 60, 0.06);
  EXPECT_LT(o.work, 0.01);
  std::printf("Falcon's encoder: tremor %.4f N\n", o.tremor);
}

}  // namespace
}  // namespace palpate::haptics
