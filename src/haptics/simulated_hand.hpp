// SPDX-License-Identifier: Apache-2.0
// A device without hardware: a mass on a spring and a damper that follows a path and yields to the
// force. Closes the loop in tests and demonstrations.
#pragma once
#include <vector>

#include "haptics/device.hpp"
#include "haptics/touch_model.hpp"
#include "haptics/workspace.hpp"

namespace palpate::haptics {

/// Where the hand wants to be at a time; between waypoints it eases from one to the next.
struct Waypoint {
  double time = 0;               ///< [s] ascending
  Vec3 position = Vec3::Zero();  ///< [mm] user's axes
};

/// What goes wrong, and when; for tests of the watchdog.
struct HandFault {
  enum class Kind : std::uint8_t { lost, stale, not_finite, refuses_force } kind = Kind::lost;
  double from = 0;  ///< [s]
  double to = 0;    ///< [s]
};

struct SimulatedHandOptions {
  double rate_hz = 1000;   ///< [Hz] time advances by one period with each read
  double mass = 1.5e-4;    ///< [N s^2/mm] 0.15 kg: hand and moving part of a device; > 0
  double stiffness = 0.5;  ///< [N/mm] of the arm; published 0.1 to 1; >= 0
  double damping = 0.005;  ///< [N s/mm] of the arm; published 0.003 to 0.02; >= 0
  double resolution = 0;   ///< [mm] of the encoders; 0 is exact. A Falcon has 0.06
  bool repeat = false;     ///< start over after the last waypoint
  bool reports_velocity = false;
  std::uint32_t buttons = 0;
  DeviceLimits limits = unlimited();
  std::vector<HandFault> faults;
};

class SimulatedHand final : public Device {
 public:
  /// Starts at rest at the first waypoint. @throws InputError  no waypoint, or times that do not
  /// ascend, or an option out of range
  explicit SimulatedHand(std::vector<Waypoint> path, const SimulatedHandOptions& options = {});

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  [[nodiscard]] DeviceStatus read(DeviceSample& sample) noexcept override;
  DeviceStatus write(const Vec3& force) noexcept override;
  void release() noexcept override;

  void set_buttons(std::uint32_t buttons) noexcept { options_.buttons = buttons; }
  [[nodiscard]] double time() const { return time_; }               ///< [s] simulated
  [[nodiscard]] const Vec3& position() const { return position_; }  ///< [mm] true, not quantised
  [[nodiscard]] const Vec3& force() const { return force_; }        ///< [N] last written
  /// [N mm] work that the device's force has done on the hand since the start, without
  /// error: the force is constant over a substep, so that its work is force times way.
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] bool finished() const;

 private:
  void step(double dt) noexcept;
  [[nodiscard]] Vec3 target(double time) const noexcept;
  [[nodiscard]] bool failing(HandFault::Kind kind) const noexcept;

  std::vector<Waypoint> path_;
  SimulatedHandOptions options_;
  DeviceInfo info_;
  Vec3 position_, velocity_ = Vec3::Zero(), force_ = Vec3::Zero();
  double time_ = 0;
  double work_ = 0;
  std::uint64_t number_ = 0;
};

/// One region: approach from outside, press until `force` [N] would be reached, slide 20 mm to and
/// fro, rest for a second, lift. Starts and ends at the same place, so that it can be repeated; 5
/// s. Head frame; use with a Workspace of identity.
/// @throws InputError  the head has no vertex of that region
[[nodiscard]] std::vector<Waypoint> region_press(const TouchModel& model, SkinRegion region,
                                                 double force, double hand_stiffness);
/// The same on every region that the head has, one after the other, going round the head in
/// between, and at last back to the start. About 8 s per region.
[[nodiscard]] std::vector<Waypoint> region_tour(const TouchModel& model, double force,
                                                double hand_stiffness);
/// Wanders at random through a shell around the head, in and out of contact, at up to `speed` mm/s.
[[nodiscard]] std::vector<Waypoint> random_walk(const TouchModel& model, std::uint64_t seed,
                                                double seconds, double speed);

}  // namespace palpate::haptics
