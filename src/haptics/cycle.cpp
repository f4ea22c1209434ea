// SPDX-License-Identifier: Apache-2.0
#include "haptics/cycle.hpp"

#include <algorithm>

namespace palpate::haptics {

TouchCycle::TouchCycle(const TickSetup& setup, Device& device, const Workspace& workspace,
                       const CycleOptions& options, Recorder* recorder)
    : setup_(setup),
      device_(device),
      options_(options),
      recorder_(recorder),
      workspace_(workspace),
      wish_(workspace) {
  workspace_number_ = wish_.number();
}

// The tool stays where the clutch caught it; the device moves freely and takes it up again there.
void TouchCycle::handle_clutch() noexcept {
  const bool held = options_.clutch_button >= 0 &&
                    ((sample_.buttons >> static_cast<unsigned>(options_.clutch_button)) & 1U) != 0;
  if (clutch_ && !held) {
    workspace_.at_user = sample_.position;
    workspace_.at_head = tool_;
    moved_ = true;
  }
  clutch_ = held;
}

// Reads the device; a sample that cannot be trusted leaves the last good one in place.
Trip TouchCycle::take_sample(std::int64_t now_ns, std::int64_t late_ns, Clock clock) noexcept {
  DeviceSample sample = sample_;
  status_ = device_.read(sample);
  const std::int64_t waited = clock ? clock() - now_ns : 0;
  if (status_ != DeviceStatus::ok) return Trip::device;
  if (!sample.position.allFinite() || (sample.has_velocity && !sample.velocity.allFinite()))
    return Trip::not_finite;
  if (sample.number != sample_.number || fresh_ns_ == 0) fresh_ns_ = now_ns;
  sample_ = sample;
  handle_clutch();
  constexpr double kNano = 1e-9;  // [s]
  if (kNano * static_cast<double>(now_ns - fresh_ns_) > options_.stale) return Trip::stale;
  // A transfer that hung is a late tick as well.
  if (kNano * static_cast<double>(std::max(late_ns, waited)) > options_.late) return Trip::late;
  if (paused_.load(std::memory_order_relaxed)) return Trip::paused;
  return clutch_ ? Trip::clutch : Trip::none;
}

void TouchCycle::note_trip(Trip trip) noexcept {
  if (trip != trip_ && trip != Trip::none) {
    auto& count = trips_[static_cast<std::size_t>(trip)];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  trip_ = trip;
}

void TouchCycle::advance(std::int64_t now_ns, std::int64_t late_ns, Clock clock) noexcept {
  std::uint64_t number = 0;
  const Workspace wish = wish_.load(number);
  if (number != workspace_number_) {
    workspace_number_ = number;
    workspace_ = wish;
    moved_ = true;
  }
  note_trip(take_sample(now_ns, late_ns, clock));

  TickInput input;
  if (!clutch_) tool_ = workspace_.to_head(sample_.position);
  input.position = tool_;
  input.velocity = workspace_.velocity_to_head(sample_.velocity);
  input.has_velocity = sample_.has_velocity;
  input.dt = last_ns_ ? 1e-9 * static_cast<double>(now_ns - last_ns_) : 0.001;
  input.hold = trip_ != Trip::none || moved_;
  last_ns_ = now_ns;
  moved_ = false;

  if (recorder_) recorder_->before_tick(state_);
  const TickOutput out = tick(setup_, input, state_);
  user_force_ = workspace_.force_to_user(out.force);
  const DeviceStatus written = device_.write(user_force_);
  if (status_ == DeviceStatus::ok) status_ = written;
  if (recorder_)
    recorder_->after_tick(input, out,
                          {now_ns, late_ns, sample_.buttons, static_cast<std::uint8_t>(trip_)});
  publish(out, now_ns);
}

void TouchCycle::publish(const TickOutput& out, std::int64_t now_ns) noexcept {
  CycleSnapshot s;
  s.out = out;
  s.tool = tool_;
  s.velocity = state_.velocity;
  s.user_force = user_force_;
  s.workspace = workspace_;
  s.time_ns = now_ns;
  s.ticks = state_.ticks;
  s.buttons = sample_.buttons;
  s.balance = state_.balance;
  s.removed = state_.removed;
  s.device = status_;
  s.trip = trip_;
  snapshot_.store(s);
}

}  // namespace palpate::haptics
