// SPDX-License-Identifier: Apache-2.0
// What happens once per tick around tick(): device in, workspace, clutch, watchdog, device out.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

#include "haptics/device.hpp"
#include "haptics/recorder.hpp"
#include "haptics/seqlock.hpp"
#include "haptics/tick.hpp"
#include "haptics/workspace.hpp"

namespace palpate::haptics {

/// Why the watchdog holds the force at zero.
enum class Trip : std::uint8_t { none, late, device, stale, not_finite, paused, clutch };
inline constexpr std::array<std::string_view, 7> kTripNames = {
    "none", "late", "device", "stale", "not finite", "paused", "clutch"};
[[nodiscard]] constexpr std::string_view name(Trip t) {
  return kTripNames[static_cast<std::size_t>(t)];
}

struct CycleOptions {
  double late = 0.005;    ///< [s] a tick that comes later than this finds the force at zero; > 0
  double stale = 0.020;   ///< [s] a device that repeats its sample for longer is not trusted; > 0
  int clutch_button = 1;  ///< bit of the button that re-indexes the workspace; -1 for none
};

/// The latest tick, for everything that looks on.
struct CycleSnapshot {
  TickOutput out;
  Vec3 tool = Vec3::Zero();        ///< [mm] tool's centre, head frame
  Vec3 velocity = Vec3::Zero();    ///< [mm/s] filtered, head frame
  Vec3 user_force = Vec3::Zero();  ///< [N] as written to the device, user's axes
  Workspace workspace;
  std::int64_t time_ns = 0;  ///< monotonic clock at the start of the tick
  std::uint64_t ticks = 0;
  std::uint32_t buttons = 0;
  double balance = 0;  ///< [N mm] of the passivity controller
  double removed = 0;  ///< [N mm] taken out by it since the start
  DeviceStatus device = DeviceStatus::waiting;
  Trip trip = Trip::none;
};

/// One touch: a set-up, a device and the memory between ticks. advance() is for one thread; the
/// other members may be called from any.
class TouchCycle {
 public:
  /// @param recorder  gets every tick; may be null. All three outlive the cycle.
  TouchCycle(const TickSetup& setup, Device& device, const Workspace& workspace,
             const CycleOptions& options = {}, Recorder* recorder = nullptr);

  using Clock = std::int64_t (*)() noexcept;  ///< [ns] the one that `now_ns` was read from
  /// One tick at time `now_ns`, `late_ns` after its deadline. With a clock, a device whose read()
  /// takes longer than `late` makes the tick late too; without one, simulated time stands still
  /// during a tick. Allocates nothing, takes no lock, throws nothing; the only calls out are the
  /// device's read() and write().
  void advance(std::int64_t now_ns, std::int64_t late_ns, Clock clock = nullptr) noexcept;

  /// The latest tick; never waits for the loop.
  [[nodiscard]] CycleSnapshot latest() const noexcept { return snapshot_.load(); }
  /// Turns or moves the head under the device; takes effect at the next tick, with a soft start.
  /// One thread at a time.
  void set_workspace(const Workspace& workspace) noexcept { wish_.store(workspace); }
  /// Force off until resumed.
  void pause(bool on) noexcept { paused_.store(on, std::memory_order_relaxed); }
  /// How often each reason began, by Trip.
  [[nodiscard]] std::uint64_t trips(Trip reason) const noexcept {
    return trips_[static_cast<std::size_t>(reason)].load(std::memory_order_relaxed);
  }
  [[nodiscard]] const TickSetup& setup() const { return setup_; }
  [[nodiscard]] Device& device() const { return device_; }

 private:
  [[nodiscard]] Trip take_sample(std::int64_t now_ns, std::int64_t late_ns, Clock clock) noexcept;
  void handle_clutch() noexcept;
  void note_trip(Trip trip) noexcept;
  void publish(const TickOutput& out, std::int64_t now_ns) noexcept;

  const TickSetup& setup_;
  Device& device_;
  CycleOptions options_;
  Recorder* recorder_;
  Workspace workspace_;
  TickState state_;
  DeviceSample sample_;
  DeviceStatus status_ = DeviceStatus::waiting;
  Trip trip_ = Trip::none;
  Vec3 tool_ = Vec3::Zero();
  Vec3 user_force_ = Vec3::Zero();
  std::int64_t last_ns_ = 0;
  std::int64_t fresh_ns_ = 0;  // when the sample's number last changed
  std::uint64_t workspace_number_ = 0;
  bool clutch_ = false;
  bool moved_ = false;  // the workspace changed: this tick starts afresh

  SeqLock<CycleSnapshot> snapshot_;
  SeqLock<Workspace> wish_;
  std::atomic<bool> paused_{false};
  std::array<std::atomic<std::uint64_t>, kTripNames.size()> trips_{};
};

}  // namespace palpate::haptics
