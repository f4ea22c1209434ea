// SPDX-License-Identifier: GPL-3.0-or-later
// Touch as a study wants it: one posed place at a time, every tick as a sample.
#pragma once
#include <atomic>
#include <memory>
#include <vector>

#include "haptics/loop.hpp"
#include "haptics/simulated_hand.hpp"
#include "haptics/spsc_queue.hpp"
#include "study/records.hpp"
#include "study/run.hpp"

namespace palpate::app {

/// A place of the head at the middle of the device's workspace, its normal towards the user.
[[nodiscard]] haptics::Workspace pose_of(const study::StudyRegion& region,
                                         const haptics::DeviceInfo& device);
/// The place of each of the protocol's regions, with the map's stiffness there.
/// @throws InputError  the head has no such region, or no curve there
[[nodiscard]] std::vector<study::StudyRegion> study_regions(const haptics::TouchModel& model,
                                                            const std::vector<std::string>& names);

/// The set-up for `factor` times the head's stiffness. `largest` is the largest factor of the
/// experiment: a device too weak or too soft for it gets all of the experiment's forces smaller, so
/// that differences stay what they are. @throws InputError
[[nodiscard]] haptics::TickSetup study_setup(const haptics::TouchModel& model,
                                             const haptics::DeviceLimits& limits,
                                             const haptics::TickOptions& options, double factor,
                                             double largest);

/// Largest factor that a part may ask for: 1 outside a discrimination.
[[nodiscard]] double largest_factor(const study::Protocol& protocol, const std::string& part);

/// Path of a simulated hand, user's axes: down to the place, press, hold, lift, beside, and again
/// until `seconds` are over. @param force  [N] that the hand would press a wall with
[[nodiscard]] std::vector<haptics::Waypoint> probing(const haptics::DeviceInfo& device,
                                                     double tool_radius, double seconds,
                                                     double force, double hand_stiffness);

/// Runs the loop against a device, one place after the other. One thread.
class StudyTouch {
 public:
  /// `model` and `device` outlive it. @param rate_hz, priority  of the loop
  StudyTouch(const haptics::TouchModel& model, haptics::Device& device, double rate_hz,
             int priority);
  ~StudyTouch();
  StudyTouch(const StudyTouch&) = delete;
  StudyTouch& operator=(const StudyTouch&) = delete;

  void begin(const study::StudyRegion& region, const study::Screen& screen, double largest);
  void end();  ///< force off; no effect where nothing is touched
  void pause(bool on);
  [[nodiscard]] bool touching() const { return loop_ != nullptr; }
  /// All ticks since the last call, head frame, in order. Call at least every two seconds.
  [[nodiscard]] std::vector<study::HapticSample> drain();
  [[nodiscard]] std::uint64_t dropped() const;
  [[nodiscard]] haptics::CycleSnapshot latest() const;
  [[nodiscard]] const haptics::TouchModel& model() const { return model_; }
  [[nodiscard]] const haptics::Device& device() const { return device_; }

 private:
  class Tap;
  const haptics::TouchModel& model_;
  haptics::Device& device_;
  double rate_hz_;
  int priority_;
  std::unique_ptr<Tap> tap_;
  haptics::Workspace pose_;
  haptics::TickSetup setup_;
  std::unique_ptr<haptics::TouchCycle> cycle_;
  std::unique_ptr<haptics::TouchLoop> loop_;
};

}  // namespace palpate::app
