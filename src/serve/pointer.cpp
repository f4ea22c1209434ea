// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/pointer.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::serve {

PointerDevice::PointerDevice(const PointerOptions& options) : options_(options) {
  info_.backend = "pointer";
  info_.name = "mouse, finger or keys on the page";
  info_.limits = haptics::unlimited();
}

void PointerDevice::begin(const Vec3& start, const Vec3& target) noexcept {
  wish_.start = start;
  wish_.target = target;
  ++wish_.beginning;
  shared_.store(wish_);
}

void PointerDevice::move_to(const Vec3& target) noexcept {
  wish_.target = target;
  shared_.store(wish_);
}

haptics::DeviceStatus PointerDevice::read(haptics::DeviceSample& sample) noexcept {
  constexpr double kThere = 1e-9;  // [mm] below what a double resolves at a head's size
  const Wish wish = shared_.load();
  if (wish.beginning == 0) return haptics::DeviceStatus::waiting;
  if (wish.beginning != beginning_) {
    beginning_ = wish.beginning;
    position_ = wish.start;
  }
  const Vec3 way = wish.target - position_;
  const double length = way.norm();
  const double period = 1 / options_.rate_hz;
  const double step =
      std::min(options_.speed * period, length * -std::expm1(-period / options_.lag));
  position_ = length < kThere ? wish.target : Vec3(position_ + step / length * way);
  sample.position = position_;
  sample.has_velocity = false;
  sample.buttons = 0;
  sample.number = ++number_;
  return haptics::DeviceStatus::ok;
}

haptics::DeviceStatus PointerDevice::write(const Vec3&) noexcept {
  return haptics::DeviceStatus::ok;
}

}  // namespace palpate::serve
