// SPDX-License-Identifier: Apache-2.0
// What a haptic device can do, and how a map is fitted to a weaker one.
#pragma once
#include <optional>
#include <span>
#include <string_view>

#include "haptics/touch_model.hpp"

namespace palpate::haptics {

struct DeviceLimits {
  std::string_view name;
  double peak_force = 0;        ///< [N] > 0
  double stiffness = 0;         ///< [N/mm] largest that the device renders stably, > 0
  double damping = 0;           ///< [N s/mm] largest viscous coefficient, >= 0
  double workspace_radius = 0;  ///< [mm] 0 where unknown
  double resolution = 0;        ///< [mm] step of the reported position; 0 where there is none, >= 0
};

/// The table of common devices, as their open drivers limit them (docs/method/touch.md). What the
/// device itself reports at run time wins over a row.
[[nodiscard]] std::span<const DeviceLimits> known_devices();
/// Case-insensitive; a part of the name is enough when it fits one row ("falcon").
[[nodiscard]] std::optional<DeviceLimits> limits_of(std::string_view name);
/// The published study's set-up: the Falcon's row with the force clamped at 8.7 N.
[[nodiscard]] DeviceLimits published_preset();
/// No device: forces as the map has them, up to 100 N and 100 N/mm.
[[nodiscard]] DeviceLimits unlimited();

enum class Scaling : std::uint8_t {
  none,   ///< forces as mapped; what the device cannot do is clipped
  ratio,  ///< all forces times one factor <= 1, so that regions keep their ratios
};

/// Factor for Scaling::ratio: the largest s <= 1 with s * (stiffest region's stiffness at 2 N) <=
/// limits.stiffness and s * (the map's highest force) <= limits.peak_force.
[[nodiscard]] double force_scale(const TouchModel& model, const DeviceLimits& limits);

}  // namespace palpate::haptics
