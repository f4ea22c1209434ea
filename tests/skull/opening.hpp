// SPDX-License-Identifier: GPL-3.0-or-later
// A skin whose mouth is opened without the product's own jaw.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/types.hpp"

namespace palpate {

inline constexpr double kDegree = std::numbers::pi / 180;

/// Turns about a joint, with weights of their own: they rise with the angle below the joint that
/// the mouth's line has, and fall again behind the jaw.
struct Opening {
  Vec3 joint;
  double angle;  ///< [rad]
  [[nodiscard]] Vec3 rigid(const Vec3& p, double share = 1) const {
    const Mat3 turn = Eigen::AngleAxisd(share * angle, Vec3::UnitX()).toRotationMatrix();
    return joint + turn * (p - joint);
  }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const {
    const Vec3 arm = p - joint;
    const double below = std::atan2(-arm.y(), arm.z()) / kDegree;
    const double away = std::hypot(arm.y(), arm.z());
    const auto rise = [](double t) {
      t = std::clamp(t, 0.0, 1.0);
      return t * t * (3 - 2 * t);
    };
    return rigid(p, rise((below - 20) / 22) * rise((165 - below) / 70) * rise((away - 10) / 35));
  }
};

}  // namespace palpate
