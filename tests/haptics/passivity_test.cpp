// SPDX-License-Identifier: Apache-2.0
// The closed loop of hand, device and head: no energy from nowhere, no tremor at rest.
#include <gtest/gtest.h>

#include "press.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

using scenes::bare;
using scenes::press;
using scenes::PressResult;
using scenes::stiffest;

std::vector<Waypoint> tour(const TouchModel& model, const DeviceLimits& device) {
  return region_tour(model, std::min(4.0, 0.8 * device.peak_force),
                     SimulatedHandOptions{}.stiffness);
}

TEST(Passivity, EveryDeviceAtItsStiffest) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  for (const DeviceLimits& device : known_devices()) {
    const PressResult with = press(model, device, stiffest(), tour(model, device), 40);
    EXPECT_LT(with.work, 0) << device.name;
    EXPECT_LT(with.given, 0.01) << device.name;
    EXPECT_LT(with.tremor, 0.02) << device.name;
    EXPECT_GT(with.contact, 0.3) << device.name;
    EXPECT_GT(with.rests, 3U) << device.name;
    // Nothing but the arm's own damping takes energy out, so that steps of the encoders are not
    // brought to rest: exact ones.
    DeviceLimits exact = device;
    exact.resolution = 0;
    const PressResult without = press(model, exact, bare(), tour(model, exact), 40);
    EXPECT_LT(without.work, 1e-6) << device.name;
    EXPECT_LT(without.given, 0.1) << device.name;
    EXPECT_LT(without.tremor, 0.02) << device.name;
    EXPECT_LT(press(model, device, bare(), tour(model, device), 40).work, 1e-6) << device.name;
    std::printf("%-26s work %8.2f, given %.4f N mm, tremor %.4f N  bare: %8.2f, %.4f, %.4f\n",
                std::string(device.name).c_str(), with.work, with.given, with.tremor, without.work,
                without.given, without.tremor);
  }
}

// A wall as stiff as the stiffest device can: what the loop must bear at most.
TEST(Passivity, AsStiffAsTheDeviceEverywhere) {
  for (const DeviceLimits& device : known_devices()) {
    const TouchModel model = make_touch_model(scenes::even_sphere(30, 90, device.stiffness));
    const PressResult r = press(model, device, stiffest(), tour(model, device), 20);
    EXPECT_LT(r.work, 0) << device.name;
    EXPECT_LT(r.tremor, 0.02) << device.name;
  }
}

TEST(Passivity, ACoarseEncoderDoesNotShake) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  DeviceLimits coarse = *limits_of("falcon");
  for (const double resolution : {0.03, 0.0635}) {
    coarse.resolution = resolution;
    const PressResult r = press(model, coarse, stiffest(), tour(model, coarse), 60);
    EXPECT_LT(r.work, 0);
    EXPECT_LT(r.tremor, 0.02);
    std::printf("steps of %g mm: given %.4f N mm, tremor %.4f N\n", resolution, r.given, r.tremor);
  }
}

}  // namespace
}  // namespace palpate::haptics
