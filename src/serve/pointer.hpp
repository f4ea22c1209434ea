// SPDX-License-Identifier: GPL-3.0-or-later
// A device without hardware that a mouse, a finger or keys move: the loop feels the head with it
// and the page shows the force.
#pragma once
#include "haptics/device.hpp"
#include "haptics/seqlock.hpp"

namespace palpate::serve {

struct PointerOptions {
  double rate_hz = 1000;  ///< [Hz] of the loop; > 0
  double speed = 120;     ///< [mm/s] fastest motion, that of a probing finger; > 0
  /// [s] lag behind the page, which speaks 60 times a second; > 0. Smaller shows its steps as jumps
  /// of the force.
  double lag = 0.025;
};

/// Follows the last position it was told, smoothly. It does not yield to the force: depth is what
/// the page says, force is what the head answers.
class PointerDevice final : public haptics::Device {
 public:
  explicit PointerDevice(const PointerOptions& options = {});

  /// Puts the tool at `start` at once and lets it go towards `target`; [mm], user's axes. Call
  /// before set_workspace() of a new place, so that the loop never sees the new place with the old
  /// position. One thread.
  void begin(const Vec3& start, const Vec3& target) noexcept;
  /// Where to go from here. The same thread.
  void move_to(const Vec3& target) noexcept;

  [[nodiscard]] const haptics::DeviceInfo& info() const override { return info_; }
  [[nodiscard]] haptics::DeviceStatus read(haptics::DeviceSample& sample) noexcept override;
  haptics::DeviceStatus write(const Vec3& force) noexcept override;
  void release() noexcept override {}

 private:
  struct Wish {
    Vec3 start = Vec3::Zero();
    Vec3 target = Vec3::Zero();
    std::uint64_t beginning = 0;
  };
  PointerOptions options_;
  haptics::DeviceInfo info_;
  Wish wish_;                      // of the telling thread
  haptics::SeqLock<Wish> shared_;  // to the loop
  Vec3 position_ = Vec3::Zero();   // of the loop
  std::uint64_t beginning_ = 0, number_ = 0;
};

}  // namespace palpate::serve
