// SPDX-License-Identifier: Apache-2.0
// The Inverse3 backend against a service that behaves, and one that does not.
#include <gtest/gtest.h>

#include "fake_inverse_service.hpp"
#include "haptics/find_devices.hpp"
#include "peers.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

FindOptions options_for(const FakeInverseService& service) {
  FindOptions o;
  o.inverse_port = service.port();
  o.inverse_event_port = service.event_port();
  o.timeout = 0.5;
  return o;
}

TEST(Inverse3, TurnsAxesAndUnits) {
  FakeInverseService service;
  const auto device = open_device("inverse3", options_for(service));
  EXPECT_EQ(device->info().serial, "049D");
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  // Service: x right, y away from the user, z up, in metres.
  EXPECT_LT((s.position - Vec3(10, 30, -20)).norm(), 1e-9);
  EXPECT_LT((s.velocity - Vec3(100, 300, -200)).norm(), 1e-9);
  EXPECT_TRUE(soon([&] {
    (void)device->write(Vec3(1, 2, 3));
    return service.force_x == 1 && service.force_y == -3 && service.force_z == 2;
  }));
  EXPECT_TRUE(soon([&] { return service.force_x == 0; })) << "an old force is not sent";
  EXPECT_EQ(service.malformed, 0);
}

TEST(Inverse3, ForcesThatAreNotAppliedAreNoticed) {
  FakeInverseService service({.applies_force = false});
  const auto device = open_device("inverse3", options_for(service));
  DeviceSample s;
  EXPECT_TRUE(soon([&] { return device->write(Vec3(0, 0, 2)) == DeviceStatus::ignored; }));
  EXPECT_NE(device->trouble().find("does not apply"), std::string::npos);
}

TEST(Inverse3, SafetyStopIsAStop) {
  FakeInverseService service;
  const auto device = open_device("inverse3", options_for(service));
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  EXPECT_TRUE(soon([&] {
    service.trigger_safety_stop();
    return device->read(s) == DeviceStatus::stopped;
  }));
  (void)device->write(Vec3(0, 0, 2));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(service.force_y, 0);
}

TEST(Inverse3, DisconnectsAreLost) {
  for (const bool unplug : {false, true}) {
    FakeInverseService service({.close_after = unplug ? -1 : 50});
    const auto device = open_device("inverse3", options_for(service));
    DeviceSample s;
    if (unplug) {
      ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
      service.unplug();
    }
    EXPECT_TRUE(soon([&] { return device->read(s) == DeviceStatus::lost; }));
    EXPECT_FALSE(device->trouble().empty());
  }
}

TEST(Inverse3, SlowRepliesAreStaleNotBlocking) {
  FakeInverseService service({.reply_delay_ms = 60});
  const auto device = open_device("inverse3", options_for(service));
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  TouchCycle cycle(setup, *device, Workspace{});
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  const std::int64_t start = monotonic_ns();
  for (int i = 0; i < 100; ++i) {
    cycle.advance(monotonic_ns(), 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GT(cycle.trips(Trip::stale), 0U);
  EXPECT_LT(monotonic_ns() - start, 2'000'000'000);
}

TEST(Inverse3, FaultsInContactZeroTheForce) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("Haply Inverse3"));
  FakeInverseService service;
  service.x = service.y = 0;
  service.z = 0.091;  // up
  const auto device = open_device("inverse3", options_for(service));
  const auto force = [&] { return std::abs(service.force_z.load()); };
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { service.lose_position(true); }),
            Trip::not_finite);
  service.lose_position(false);
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { service.button_b = true; }),
            Trip::clutch);
  service.button_b = false;
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { service.unplug(); }), Trip::device);
}

TEST(Inverse3, AllThatTheServiceListsAreFound) {
  FakeInverseService service({.lists_second = true});
  const auto found = find_inverse3(options_for(service));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].backend, "inverse3:049D");
  EXPECT_EQ(found[1].backend, "inverse3:1234");
  for (const DeviceFinding& f : found) {
    EXPECT_TRUE(f.usable) << f.detail;
    EXPECT_EQ(open_device(f.backend, options_for(service))->info().backend, f.backend);
  }
}

TEST(Inverse3, WhatIsMissingIsNamed) {
  FindOptions nobody;
  {
    FakeInverseService gone;
    nobody = options_for(gone);
  }
  EXPECT_NE(find_inverse3(nobody).front().detail.find("start Haply's inverse service"),
            std::string::npos);
  FakeInverseService empty({.lists_device = false});
  EXPECT_NE(find_inverse3(options_for(empty)).front().detail.find("lists no Inverse3"),
            std::string::npos);
  FakeInverseService other({.speaks_json = false});
  EXPECT_NE(find_inverse3(options_for(other)).front().detail.find("not JSON"), std::string::npos);
  FakeInverseService one;
  EXPECT_NE(reason([&] { return open_device("inverse3:ABCD", options_for(one)); }).find("ABCD"),
            std::string::npos);
  FakeInverseService old({.has_position = false});
  const auto device = open_device("inverse3", options_for(old));
  DeviceSample s;
  EXPECT_TRUE(soon([&] { return device->read(s) == DeviceStatus::lost; }));
  EXPECT_NE(device->trouble().find("cursor_position"), std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
