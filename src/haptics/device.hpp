// SPDX-License-Identifier: Apache-2.0
// A haptic device as the loop sees it. All devices speak the user's axes: +x to the user's right,
// +y up, +z towards the user; mm, N, s. Backends turn their own axes and units into these.
#pragma once
#include <cstdint>
#include <string>

#include "haptics/device_limits.hpp"

namespace palpate::haptics {

enum class DeviceStatus : std::uint8_t {
  ok,
  waiting,  ///< no sample yet
  lost,     ///< unplugged, closed, or the service ended
  stopped,  ///< the device's own safety stopped it
  ignored,  ///< it answers, but does not apply our forces
};
[[nodiscard]] std::string_view name(DeviceStatus status);

struct DeviceSample {
  Vec3 position = Vec3::Zero();  ///< [mm]
  Vec3 velocity = Vec3::Zero();  ///< [mm/s] meaningful where has_velocity
  std::uint64_t number = 0;      ///< of the sample: the same number twice is an old sample
  std::uint32_t buttons = 0;     ///< bit 0 is the main button
  bool has_velocity = false;
};

struct DeviceInfo {
  std::string backend;         ///< "simulated", "force-dimension", "inverse3", "touch"
  std::string name;            ///< model as the device tells it
  std::string serial;          ///< empty where unknown
  DeviceLimits limits;         ///< from the table, overruled by what the device reports
  Vec3 center = Vec3::Zero();  ///< [mm] middle of the workspace, user's axes
};

/// read() and write() are called by the loop's thread at haptic rate: they must not allocate, lock,
/// throw or wait beyond the device's own transfer. release() may come from another thread, at any
/// time, when the loop has stalled.
class Device {
 public:
  virtual ~Device() = default;
  [[nodiscard]] virtual const DeviceInfo& info() const = 0;
  /// Fills `sample` where the status is ok; otherwise leaves it alone.
  [[nodiscard]] virtual DeviceStatus read(DeviceSample& sample) noexcept = 0;
  /// [N] on the user's hand; finite, within the limits.
  virtual DeviceStatus write(const Vec3& force) noexcept = 0;
  /// Force off, as fast as the device can.
  virtual void release() noexcept = 0;
  /// What went wrong last, in one line for people; not for the loop's thread.
  [[nodiscard]] virtual std::string trouble() const { return {}; }
};

}  // namespace palpate::haptics
