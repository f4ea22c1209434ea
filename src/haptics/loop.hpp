// SPDX-License-Identifier: Apache-2.0
// The thread that keeps haptic time.
#pragma once
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "haptics/cycle.hpp"
#include "haptics/histogram.hpp"

namespace palpate::haptics {

struct LoopOptions {
  double rate_hz = 1000;  ///< [Hz] 100 to 4000
  /// SCHED_FIFO priority, 1 to 99, and locked memory, where the system allows; 0 asks for nothing.
  int priority = 80;
  double guard = 0.005;  ///< [s] a second thread releases the device when a tick overruns this; > 0
};

/// How many deadlines were late by less than `below_us` and ticks took less, but not less than the
/// row before says.
struct HistogramRow {
  double below_us = 0;
  std::uint64_t late = 0, tick = 0;
};

struct LoopReport {
  double rate_hz = 0;
  std::uint64_t ticks = 0;
  std::uint64_t skipped =
      0;  ///< deadlines that passed while a tick was late: ticks that never were
  std::uint64_t guarded = 0;  ///< times the guard released the device
  double late_median_us = 0, late_p999_us = 0, late_longest_us = 0;
  /// [-] share of deadlines whose tick came more than 1 ms late, or never; counted exactly.
  double late_above_1ms = 0;
  double tick_median_us = 0, tick_p999_us = 0, tick_longest_us = 0;  ///< with the device's transfer
  std::vector<HistogramRow> histogram;  ///< octaves of time, ascending; from the first that counts
  double removed = 0;                   ///< [N mm] energy that the passivity controller took out
  std::array<std::uint64_t, kTripNames.size()> trips{};
  std::vector<std::string> warnings;
};
/// A few lines for people.
[[nodiscard]] std::string text(const LoopReport& report);

/// Runs a cycle at a fixed rate. Sleeps to absolute deadlines; after an overrun it goes on with the
/// next deadline instead of catching up. Any thread may ask for the report.
class TouchLoop {
 public:
  /// @throws InputError  an option out of range
  explicit TouchLoop(TouchCycle& cycle, const LoopOptions& options = {});
  ~TouchLoop();  ///< stops
  TouchLoop(const TouchLoop&) = delete;
  TouchLoop& operator=(const TouchLoop&) = delete;

  void start();  ///< returns when the thread has asked for its priority; no effect when running
  void stop();   ///< force off, thread ended; no effect when stopped
  [[nodiscard]] bool running() const { return thread_.joinable(); }
  [[nodiscard]] LoopReport report() const;
  /// Of the delay after each deadline, and of the time from waking to the end of the tick.
  [[nodiscard]] const DurationHistogram& lateness() const { return lateness_; }
  [[nodiscard]] const DurationHistogram& tick_time() const { return tick_time_; }

 private:
  void run();
  void guard();

  TouchCycle& cycle_;
  LoopOptions options_;
  DurationHistogram lateness_, tick_time_;
  std::vector<std::string> warnings_;  // written before `ready_`
  std::atomic<bool> stop_{false}, ready_{false};
  std::atomic<std::int64_t> beat_ns_{0};
  std::atomic<std::uint64_t> skipped_{0}, guarded_{0}, late_{0};
  std::thread thread_, guard_thread_;
};

}  // namespace palpate::haptics
