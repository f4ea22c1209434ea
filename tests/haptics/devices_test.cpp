// SPDX-License-Identifier: Apache-2.0
// Each backend against a peer that behaves, and one that does not.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "fake_dhd.hpp"
#include "fake_hd.hpp"
#include "haptics/cycle.hpp"
#include "haptics/find_devices.hpp"
#include "haptics/realtime.hpp"
#include "peers.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

class ForceDimension : public testing::Test {
 protected:
  ForceDimension() {
    options_.dhd_libraries = {FAKE_DHD};
    handle_ = dlopen(FAKE_DHD, RTLD_NOW);
    auto* get = reinterpret_cast<FakeDhd* (*)()>(dlsym(handle_, "fake_dhd"));
    fake_ = get();
    *fake_ = FakeDhd{};
  }
  ~ForceDimension() override { dlclose(handle_); }
  FindOptions options_;
  void* handle_;
  FakeDhd* fake_;
};

TEST_F(ForceDimension, TurnsAxesAndUnits) {
  const auto device = open_device("force-dimension", options_);
  EXPECT_EQ(device->info().name, "Novint Falcon");
  EXPECT_EQ(device->info().limits.peak_force, 8.0);
  EXPECT_EQ(fake_->enabled, 1);
  DeviceSample s;
  ASSERT_EQ(device->read(s), DeviceStatus::ok);
  // SDK: x towards the user, y right, z up, in metres.
  EXPECT_LT((s.position - Vec3(20, 30, 10)).norm(), 1e-12);
  EXPECT_LT((s.velocity - Vec3(2, 3, 1)).norm(), 1e-12);
  EXPECT_EQ(device->write(Vec3(1, 2, 3)), DeviceStatus::ok);
  EXPECT_EQ(fake_->force[0], 3);
  EXPECT_EQ(fake_->force[1], 1);
  EXPECT_EQ(fake_->force[2], 2);
  EXPECT_EQ(fake_->position_id, 3) << "the id that opening gave, not a default";
}

TEST_F(ForceDimension, WhatTheDeviceReportsWins) {
  fake_->max_force = 4.5;
  EXPECT_EQ(open_device("force-dimension:0", options_)->info().limits.peak_force, 4.5);
}

TEST_F(ForceDimension, ClosesWithForceOff) {
  open_device("force-dimension", options_).reset();
  EXPECT_EQ(fake_->closed_id, 3);
  EXPECT_EQ(fake_->enabled, 0);
  EXPECT_EQ(fake_->force[0], 0);
}

TEST_F(ForceDimension, FaultsShow) {
  const auto device = open_device("force-dimension", options_);
  DeviceSample s;
  (void)device->read(s);
  const std::uint64_t number = s.number;
  fake_->position_result = 1;  // asked too soon: the same sample
  EXPECT_EQ(device->read(s), DeviceStatus::ok);
  EXPECT_EQ(s.number, number);
  fake_->position_result = -1;
  EXPECT_EQ(device->read(s), DeviceStatus::lost);
  EXPECT_EQ(device->trouble(), "fake error");
  fake_->force_result = 2;  // motors saturated: the device limits by itself
  EXPECT_EQ(device->write(Vec3::Zero()), DeviceStatus::ok);
  fake_->force_result = -1;
  EXPECT_EQ(device->write(Vec3::Zero()), DeviceStatus::lost);
}

TEST_F(ForceDimension, UnpluggedInContactIsZeroForce) {
  const TouchModel model = make_touch_model(scenes::even_sphere(30, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  const auto device = open_device("force-dimension", options_);
  TouchCycle cycle(setup, *device, Workspace{});
  std::int64_t now = 1;
  for (double z = 0.1; z > 0.092; z -= 0.0001) {
    fake_->position[0] = fake_->position[1] = 0;
    fake_->position[2] = z;
    cycle.advance(now += 1'000'000, 0);
  }
  EXPECT_GT(fake_->force[2], 1);
  fake_->position_result = -1;
  cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(fake_->force[2], 0);
  EXPECT_EQ(cycle.latest().trip, Trip::device);
  fake_->position_result = 0;
  fake_->position[1] = std::nan("");
  cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(cycle.latest().trip, Trip::not_finite);
  EXPECT_EQ(fake_->force[2], 0);
}

TEST_F(ForceDimension, EachFamilyHasItsLimits) {
  const auto stiffness = [&](const char* name) {
    fake_->name = name;
    return open_device("force-dimension", options_)->info().limits.stiffness;
  };
  EXPECT_EQ(stiffness("FALCON"), 3.0);
  EXPECT_EQ(stiffness("omega.7"), 5.0);
  EXPECT_EQ(stiffness("delta.6"), 5.0);
  EXPECT_EQ(stiffness("Lambda.7"), 8.0);
  EXPECT_EQ(stiffness("something new"), 4.0) << "the least of the maker's";
}

TEST_F(ForceDimension, ButtonsAndAStuckSample) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  const auto device = open_device("force-dimension", options_);
  TouchCycle cycle(setup, *device, Workspace{});
  std::int64_t now = 1;
  fake_->buttons = 2;
  cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(cycle.latest().trip, Trip::clutch);
  fake_->buttons = 0;
  cycle.advance(now += 1'000'000, 0);
  cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(cycle.latest().trip, Trip::none);
  fake_->position_result = 1;  // the same sample again and again
  for (int i = 0; i < 30; ++i) cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(cycle.latest().trip, Trip::stale);
}

TEST_F(ForceDimension, WhatIsMissingIsNamed) {
  const auto open = [&] { return open_device("force-dimension", options_); };
  fake_->sdk_major = 2;
  EXPECT_NE(reason(open).find("SDK 2.17.1"), std::string::npos);
  fake_->sdk_major = 3;
  fake_->refuses_open = true;
  EXPECT_NE(reason(open).find("fake error"), std::string::npos);
  fake_->refuses_open = false;
  fake_->refuses_force = true;
  EXPECT_NE(reason(open).find("does not enable its force"), std::string::npos);
  fake_->devices = 0;
  EXPECT_NE(find_force_dimension(options_).front().detail.find("no device is connected"),
            std::string::npos);
  options_.dhd_libraries = {FAKE_DHD_INCOMPLETE};
  EXPECT_NE(reason(open).find("dhdGetLinearVelocity"), std::string::npos);
  options_.dhd_libraries = {"libnothere.so.1", "libnothere.so"};
  EXPECT_NE(reason(open).find("looked for libnothere.so.1, libnothere.so"), std::string::npos);
  options_.dhd_libraries = {PALPATE_SOURCE_DIR "/Makefile"};
  EXPECT_NE(reason(open).find("Makefile"), std::string::npos);
}

class TouchDevice : public testing::Test {
 protected:
  TouchDevice() {
    options_.hd_libraries = {FAKE_HD};
    handle_ = dlopen(FAKE_HD, RTLD_NOW);
    fake_ = reinterpret_cast<FakeHd* (*)()>(dlsym(handle_, "fake_hd"))();
    fake_->present = true;
    fake_->error = 0;
    fake_->x = 1;
    fake_->max_force = 3.3;
  }
  ~TouchDevice() override { dlclose(handle_); }
  FindOptions options_;
  void* handle_;
  FakeHd* fake_;
};

TEST_F(TouchDevice, ExchangesWithTheLibrarysThread) {
  const auto device = open_device("touch", options_);
  EXPECT_EQ(device->info().limits.stiffness, 0.4);
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  EXPECT_LT((s.position - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_TRUE(s.has_velocity);
  // Forces reach the device while the loop writes them and vanish when it stops.
  EXPECT_TRUE(soon([&] {
    (void)device->write(Vec3(0.5, -0.25, 1));
    return fake_->force_x == 0.5 && fake_->force_y == -0.25 && fake_->force_z == 1;
  }));
  EXPECT_TRUE(soon([&] { return fake_->force_x == 0; })) << "an old force is not put out";
}

TEST_F(TouchDevice, ReleaseIsAtOnce) {
  const auto device = open_device("touch", options_);
  for (int i = 0; i < 20; ++i) {
    (void)device->write(Vec3(1, 0, 0));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  device->release();
  const long frames = fake_->frames;
  EXPECT_TRUE(soon([&] { return fake_->frames > frames + 1; }));
  EXPECT_EQ(fake_->force_x, 0);
}

TEST_F(TouchDevice, FaultsShow) {
  const auto device = open_device("touch", options_);
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  fake_->error = 0x0200;  // warm motors: a warning
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  fake_->error = 0;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  fake_->error = 0x0302;  // communication
  EXPECT_TRUE(soon([&] { return device->read(s) == DeviceStatus::lost; }));
  EXPECT_NE(device->trouble().find("0x0302"), std::string::npos);
  fake_->error = 0;
}

TEST_F(TouchDevice, FaultsInContactZeroTheForce) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("3D Systems Touch"));
  const auto force = [&] { return std::abs(fake_->force_y.load()); };
  const auto press = [&] {
    fake_->error = 0;
    fake_->x = fake_->z = 0;
    fake_->y = 91;
  };
  press();
  auto device = open_device("touch", options_);
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { fake_->x = std::nan(""); }),
            Trip::not_finite);
  press();
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { fake_->buttons = 2; }), Trip::clutch);
  fake_->buttons = 0;
  press();
  EXPECT_EQ(trip_in_contact(setup, *device, {}, force, [&] { fake_->error = 0x0302; }),
            Trip::device);
  fake_->error = 0;
}

TEST_F(TouchDevice, ASchedulerThatStandsStillIsStale) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 1));
  const TickSetup setup = make_tick_setup(model, *limits_of("3D Systems Touch"));
  const auto device = open_device("touch", options_);
  TouchCycle cycle(setup, *device, Workspace{});
  DeviceSample s;
  ASSERT_TRUE(soon([&] { return device->read(s) == DeviceStatus::ok; }));
  fake_->stalled = true;
  EXPECT_TRUE(soon([&] {
    cycle.advance(monotonic_ns(), 0);
    return cycle.latest().trip == Trip::stale;
  }));
  EXPECT_EQ(cycle.latest().user_force.norm(), 0);
  fake_->stalled = false;
}

TEST_F(TouchDevice, WhatIsMissingIsNamed) {
  fake_->present = false;
  EXPECT_NE(find_touch(options_).front().detail.find("set-up program"), std::string::npos);
  options_.hd_libraries = {FAKE_DHD};
  EXPECT_NE(find_touch(options_).front().detail.find("lacks hdInitDevice"), std::string::npos);
  options_.hd_libraries = {"libnothere.so"};
  EXPECT_NE(find_touch(options_).front().detail.find("OpenHaptics"), std::string::npos);
}

TEST(FindDevices, AnEmptyMachineListsWhatIsMissing) {
  FindOptions nothing;
  nothing.dhd_libraries = {"libnothere.so"};
  nothing.hd_libraries = {"libnothere.so"};
  nothing.inverse_port = 1;
  nothing.timeout = 0.2;
  const auto found = list_devices(nothing);
  ASSERT_EQ(found.size(), 4U);
  EXPECT_TRUE(found[0].usable);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_FALSE(found[i].usable);
    EXPECT_FALSE(found[i].detail.empty());
    std::printf("%s: %s\n", found[i].backend.c_str(), found[i].detail.c_str());
  }
  const std::string why = reason([&] { return open_device("auto", nothing); });
  EXPECT_NE(why.find("libnothere.so"), std::string::npos);
  EXPECT_NE(reason([&] { return open_device("mouse", nothing); }).find("mouse"), std::string::npos);
  EXPECT_NE(reason([&] { return open_device("force-dimension:x", nothing); }).find("number"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
