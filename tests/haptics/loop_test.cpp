// SPDX-License-Identifier: Apache-2.0
// Cycle, watchdog, clutch, the thread and its exchange with the rest.
#include "haptics/loop.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "core/error.hpp"
#include "counters.hpp"
#include "haptics/simulated_hand.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;  // [ns]

std::vector<Waypoint> press_from_above(double depth) {
  return {
      {0, Vec3(0, 130, 0)}, {0.5, Vec3(0, 90 + 5 - depth, 0)}, {60, Vec3(0, 90 + 5 - depth, 0)}};
}

class Cycle : public testing::Test {
 protected:
  TouchModel model_ = make_touch_model(scenes::even_sphere(30, 90, 1));
  TickSetup setup_ = make_tick_setup(model_, *limits_of("falcon"));
  SimulatedHandOptions hand_options() {
    SimulatedHandOptions o;
    o.limits = setup_.limits;
    return o;
  }
  static void run(TouchCycle& cycle, std::int64_t& now, int ticks, std::int64_t late = 0) {
    for (int i = 0; i < ticks; ++i) cycle.advance(now += kMillisecond, late);
  }
};

TEST_F(Cycle, FaultsZeroTheForceAndRecoverSoftly) {
  using Kind = HandFault::Kind;
  const std::array<std::pair<Kind, Trip>, 3> cases = {{{Kind::lost, Trip::device},
                                                       {Kind::stale, Trip::stale},
                                                       {Kind::not_finite, Trip::not_finite}}};
  for (const auto& [kind, trip] : cases) {
    SimulatedHandOptions o = hand_options();
    o.faults = {{kind, 1.0, 1.2}};
    SimulatedHand hand(press_from_above(4), o);
    TouchCycle cycle(setup_, hand, Workspace{});
    std::int64_t now = 1;
    run(cycle, now, 999);
    EXPECT_GT(cycle.latest().out.force.norm(), 0.5);
    EXPECT_EQ(cycle.latest().trip, Trip::none);
    run(cycle, now, 30);
    EXPECT_EQ(cycle.latest().trip, trip) << name(trip);
    EXPECT_EQ(cycle.latest().out.force.norm(), 0);
    EXPECT_EQ(hand.force().norm(), 0);
    run(cycle, now, 171 + 5);  // the fault is over
    EXPECT_EQ(cycle.latest().trip, Trip::none);
    EXPECT_LT(cycle.latest().out.force.norm(), 0.2) << "soft start";
    run(cycle, now, 400);
    EXPECT_GT(cycle.latest().out.force.norm(), 0.5);
    EXPECT_EQ(cycle.trips(trip), 1U);
  }
}

TEST_F(Cycle, ALateTickFindsZeroForce) {
  SimulatedHand hand(press_from_above(4), hand_options());
  TouchCycle cycle(setup_, hand, Workspace{});
  std::int64_t now = 1;
  run(cycle, now, 1000);
  EXPECT_GT(cycle.latest().out.force.norm(), 0.5);
  now += 7 * kMillisecond;
  run(cycle, now, 1, 7 * kMillisecond);
  EXPECT_EQ(cycle.latest().trip, Trip::late);
  EXPECT_EQ(cycle.latest().out.force.norm(), 0);
  run(cycle, now, 1, 4 * kMillisecond);
  EXPECT_EQ(cycle.latest().trip, Trip::none);
}

TEST_F(Cycle, ADeviceThatDoesNotApplyForcesIsReported) {
  SimulatedHandOptions o = hand_options();
  o.faults = {{HandFault::Kind::refuses_force, 0.9, 1.5}};
  SimulatedHand hand(press_from_above(4), o);
  TouchCycle cycle(setup_, hand, Workspace{});
  std::int64_t now = 1;
  run(cycle, now, 1000);
  EXPECT_EQ(cycle.latest().device, DeviceStatus::ignored);
}

TEST_F(Cycle, ClutchMovesTheWorkspaceAndNotTheTool) {
  SimulatedHand hand({{0, Vec3(0, 120, 0)}, {1, Vec3(0, 120, 0)}, {2, Vec3(30, 120, 0)}},
                     hand_options());
  TouchCycle cycle(setup_, hand, Workspace{});
  std::int64_t now = 1;
  run(cycle, now, 900);
  const Vec3 before = cycle.latest().tool;
  hand.set_buttons(2);
  run(cycle, now, 1500);
  EXPECT_EQ(cycle.latest().trip, Trip::clutch);
  EXPECT_LT((cycle.latest().tool - before).norm(), 1e-9);
  hand.set_buttons(0);
  run(cycle, now, 10);
  EXPECT_LT((cycle.latest().tool - before).norm(), 0.1);
  EXPECT_NEAR(cycle.latest().workspace.at_user.x(), 30, 0.2);
}

TEST_F(Cycle, PauseHoldsTheForceAtZero) {
  SimulatedHand hand(press_from_above(4), hand_options());
  TouchCycle cycle(setup_, hand, Workspace{});
  std::int64_t now = 1;
  run(cycle, now, 1000);
  cycle.pause(true);
  run(cycle, now, 1);
  EXPECT_EQ(cycle.latest().out.force.norm(), 0);
  EXPECT_EQ(cycle.latest().trip, Trip::paused);
}

TEST_F(Cycle, AllocatesAndLocksNothing) {
  SimulatedHand hand(press_from_above(4), hand_options());
  TouchCycle cycle(setup_, hand, Workspace{});
  std::int64_t now = 1;
  Workspace turned;
  turned.at_head = Vec3(0, 1, 0);
  const QuietScope quiet;
  run(cycle, now, 2000);
  cycle.set_workspace(turned);
  run(cycle, now, 2000);
  (void)cycle.latest();
  EXPECT_EQ(quiet.allocations(), 0);
  EXPECT_EQ(quiet.locks(), 0);
}

TEST(Workspace, AimsARegionAtTheUser) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  DeviceInfo device;
  device.center = Vec3(1, 2, 3);
  for (const SkinRegion region : {SkinRegion::cranium, SkinRegion::forehead, SkinRegion::jaw}) {
    const Workspace w = aimed_at(model, region, device);
    EXPECT_NEAR(w.rotation.determinant(), 1, 1e-12);
    EXPECT_LT((w.to_head(device.center) - w.at_head).norm(), 1e-12);
    const SurfacePoint near = model.mesh.nearest(w.at_head, 1e300);
    EXPECT_LT(near.distance2, 1e-12);
    EXPECT_EQ(model.region_at(near), region);
    const Vec3 towards_user = w.rotation * Vec3::UnitZ();
    EXPECT_GT(towards_user.dot(model.mesh.blended_normal(near)), 0.999);
    // Forces turn back the way positions turned.
    EXPECT_LT((w.force_to_user(towards_user) - Vec3::UnitZ()).norm(), 1e-12);
  }
  EXPECT_THROW((void)aimed_at(model, SkinRegion::ear, device), InputError);
}

TEST(Histogram, QuantilesAndShares) {
  DurationHistogram h;
  EXPECT_EQ(h.quantile_us(0.5), 0);
  for (int i = 1; i <= 1000; ++i) h.add(i * 1000);
  EXPECT_EQ(h.total(), 1000U);
  EXPECT_NEAR(h.quantile_us(0.5), 500, 65);
  EXPECT_NEAR(h.quantile_us(0.999), 1000, 125);
  EXPECT_EQ(h.longest_us(), 1000);
  EXPECT_NEAR(h.share_above_us(900), 0.1, 0.07);
  h.add(-5);
  h.add(std::int64_t{1} << 60);
  EXPECT_EQ(h.total(), 1002U);
  for (int i = 1; i + 1 < DurationHistogram::kBuckets; ++i)
    EXPECT_EQ(DurationHistogram::upper_us(i), DurationHistogram::lower_us(i + 1));
}

TEST(SeqLock, ReadersSeeWholeValues) {
  struct Pair {
    std::array<std::uint64_t, 40> values{};
  };
  SeqLock<Pair> lock;
  std::atomic<bool> stop{false};
  std::atomic<long> torn{0}, reads{0};
  std::thread reader([&] {
    while (!stop) {
      const Pair p = lock.load();
      for (const std::uint64_t v : p.values)
        if (v != p.values[0]) ++torn;
      ++reads;
    }
  });
  for (std::uint64_t i = 0; i < 200000 || reads < 100; ++i) {
    Pair p;
    p.values.fill(i);
    lock.store(p);
  }
  stop = true;
  reader.join();
  EXPECT_EQ(torn, 0);
  EXPECT_GT(lock.number(), 200000U);
}

TEST_F(Cycle, TheThreadKeepsTheRateAndStops) {
  SimulatedHandOptions o = hand_options();
  o.repeat = true;
  SimulatedHand hand(press_from_above(4), o);
  TouchCycle cycle(setup_, hand, Workspace{});
  LoopOptions options;
  options.rate_hz = 1000;
  TouchLoop loop(cycle, options);
  const auto start = std::chrono::steady_clock::now();
  loop.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const CycleSnapshot seen = cycle.latest();
  loop.stop();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const LoopReport r = loop.report();
  EXPECT_NEAR(static_cast<double>(r.ticks + r.skipped), 1000 * seconds, 0.2 * 1000 * seconds + 50);
  EXPECT_GT(seen.ticks, 0U);
  EXPECT_EQ(hand.force().norm(), 0) << "released at the end";
  EXPECT_NE(text(r).find("lateness"), std::string::npos);
  std::printf("%s", text(r).c_str());
}

// A device whose transfer hangs: the guard takes the force away while the loop is stuck.
class Hanging final : public Device {
 public:
  const DeviceInfo& info() const override { return info_; }
  DeviceStatus read(DeviceSample& s) noexcept override {
    if (++reads_ == 50) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    s.number = static_cast<std::uint64_t>(reads_);
    s.position = Vec3(0, 92, 0);  // 3 mm deep, from the first tick on
    return DeviceStatus::ok;
  }
  DeviceStatus write(const Vec3& force) noexcept override {
    if (reads_ == 50) at_hang_ = force.norm();
    if (reads_ == 60) after_hang_ = force.norm();
    return DeviceStatus::ok;
  }
  void release() noexcept override {
    if (reads_ == 50) ++released_;
  }
  std::atomic<int> reads_{0}, released_{0};
  std::atomic<double> at_hang_{-1}, after_hang_{-1};
  DeviceInfo info_;
};

TEST_F(Cycle, TheGuardReleasesAStuckDevice) {
  Hanging device;
  TouchCycle cycle(setup_, device, Workspace{});
  LoopOptions options;
  options.priority = 0;
  TouchLoop loop(cycle, options);
  loop.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  loop.stop();
  EXPECT_GE(device.released_, 1);
  const LoopReport r = loop.report();
  EXPECT_GE(r.guarded, 1U);
  EXPECT_GE(r.trips[static_cast<std::size_t>(Trip::late)], 1U);
  EXPECT_EQ(device.at_hang_, 0) << "the tick that hung puts no force out";
  EXPECT_LT(device.after_hang_, 0.5) << "and what follows starts soft";
  // About 99 of the deadlines never had a tick: they count as late.
  EXPECT_GE(r.skipped, 90U);
  EXPECT_GE(r.late_above_1ms, 90.0 / static_cast<double>(r.ticks + r.skipped));
}

TEST_F(Cycle, LoopOptionsOutOfRangeAreRefused) {
  SimulatedHand hand(press_from_above(1), hand_options());
  TouchCycle cycle(setup_, hand, Workspace{});
  LoopOptions options;
  options.rate_hz = 10;
  EXPECT_THROW(TouchLoop(cycle, options), InputError);
}

}  // namespace
}  // namespace palpate::haptics
