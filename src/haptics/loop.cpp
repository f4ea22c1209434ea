// SPDX-License-Identifier: Apache-2.0
#include "haptics/loop.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "haptics/realtime.hpp"

namespace palpate::haptics {

namespace {

constexpr std::int64_t kLate = 1'000'000;  // [ns] beyond which a tick counts as late in the report

// Only one thread writes each count, so a load and a store do.
void bump(std::atomic<std::uint64_t>& count, std::uint64_t by) noexcept {
  count.store(count.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
}

// A row an octave; the buckets are an eighth of one.
std::vector<HistogramRow> octaves(const DurationHistogram& late, const DurationHistogram& tick) {
  constexpr int kOctave = 8;
  std::vector<HistogramRow> rows;
  for (int i = 0; i + kOctave < DurationHistogram::kBuckets; i += kOctave) {
    HistogramRow row{DurationHistogram::upper_us(i + kOctave), 0, 0};
    for (int k = i == 0 ? 0 : i + 1; k <= i + kOctave; ++k) {
      row.late += late.count(k);
      row.tick += tick.count(k);
    }
    if (!rows.empty() || row.late + row.tick > 0) rows.push_back(row);
  }
  while (!rows.empty() && rows.back().late + rows.back().tick == 0) rows.pop_back();
  return rows;
}

std::string histogram_text(const std::vector<HistogramRow>& rows) {
  if (rows.empty()) return {};
  std::string out = fmt::format("{:>14} {:>12} {:>12}\n", "below", "late", "tick time");
  for (const HistogramRow& row : rows)
    out += fmt::format("{:>11.1f} us {:>12} {:>12}\n", row.below_us, row.late, row.tick);
  return out;
}

}  // namespace

TouchLoop::TouchLoop(TouchCycle& cycle, const LoopOptions& options)
    : cycle_(cycle), options_(options) {
  if (!(options.rate_hz >= 100 && options.rate_hz <= 4000))
    throw InputError(fmt::format("the loop's rate is {} Hz; give 100 to 4000", options.rate_hz));
  if (options.priority < 0 || options.priority > 99)
    throw InputError(fmt::format("real-time priority is {}; give 0 to 99", options.priority));
  if (!(options.guard > 0))
    throw InputError(fmt::format("the guard's time is {} s; it must be positive", options.guard));
}

TouchLoop::~TouchLoop() {
  stop();
}

void TouchLoop::start() {
  if (running()) return;
  stop_ = false;
  ready_ = false;
  beat_ns_ = 0;
  thread_ = std::thread([this] { run(); });
  while (!ready_.load(std::memory_order_acquire)) std::this_thread::yield();
  guard_thread_ = std::thread([this] { guard(); });
}

void TouchLoop::stop() {
  if (!running()) return;
  stop_ = true;
  thread_.join();
  guard_thread_.join();
  cycle_.device().release();
}

void TouchLoop::run() {
  if (options_.priority > 0) warnings_ = ask_for_realtime(options_.priority);
  sharpen_timer();
  prefault_stack();
  ready_.store(true, std::memory_order_release);

  const auto period = static_cast<std::int64_t>(1e9 / options_.rate_hz);
  std::int64_t deadline = monotonic_ns() + period;
  std::int64_t last = deadline - period;
  while (!stop_.load(std::memory_order_relaxed)) {
    sleep_until_ns(deadline);
    const std::int64_t now = monotonic_ns();
    beat_ns_.store(now, std::memory_order_relaxed);
    lateness_.add(now - deadline);
    if (now - deadline > kLate) bump(late_, 1);
    // After a transfer that hung, deadlines were skipped: this tick may be in time, but the device
    // has held its force since the last one.
    cycle_.advance(now, std::max(now - deadline, now - last - period), monotonic_ns);
    last = now;
    const std::int64_t done = monotonic_ns();
    tick_time_.add(done - now);
    deadline += period;
    if (deadline <= done) {
      const std::int64_t behind = (done - deadline) / period + 1;
      bump(skipped_, static_cast<std::uint64_t>(behind));
      deadline += behind * period;
    }
  }
  beat_ns_.store(0, std::memory_order_relaxed);
}

// The loop itself finds out that it was late only when it wakes; until then the device would hold
// the last force.
void TouchLoop::guard() {
  if (options_.priority > 0)
    (void)ask_for_realtime(options_.priority);  // the loop told of refusals
  const auto patience = static_cast<std::int64_t>(1e9 * (options_.guard + 1 / options_.rate_hz));
  std::int64_t released_at = -1;
  while (!stop_.load(std::memory_order_relaxed)) {
    sleep_until_ns(monotonic_ns() + 1'000'000);
    const std::int64_t beat = beat_ns_.load(std::memory_order_relaxed);
    if (beat == 0 || beat == released_at || monotonic_ns() - beat <= patience) continue;
    cycle_.device().release();
    released_at = beat;
    bump(guarded_, 1);
  }
}

LoopReport TouchLoop::report() const {
  LoopReport r;
  r.rate_hz = options_.rate_hz;
  r.ticks = lateness_.total();
  r.skipped = skipped_.load(std::memory_order_relaxed);
  r.guarded = guarded_.load(std::memory_order_relaxed);
  r.late_median_us = lateness_.quantile_us(0.5);
  r.late_p999_us = lateness_.quantile_us(0.999);
  r.late_longest_us = lateness_.longest_us();
  const std::uint64_t late = late_.load(std::memory_order_relaxed) + r.skipped;
  const std::uint64_t all = r.ticks + r.skipped;
  r.late_above_1ms = all > 0 ? static_cast<double>(late) / static_cast<double>(all) : 0;
  r.tick_median_us = tick_time_.quantile_us(0.5);
  r.tick_p999_us = tick_time_.quantile_us(0.999);
  r.tick_longest_us = tick_time_.longest_us();
  r.histogram = octaves(lateness_, tick_time_);
  r.removed = cycle_.latest().removed;
  for (std::size_t i = 0; i < r.trips.size(); ++i) r.trips[i] = cycle_.trips(static_cast<Trip>(i));
  if (ready_.load(std::memory_order_acquire)) r.warnings = warnings_;
  return r;
}

std::string text(const LoopReport& r) {
  std::string out = fmt::format(
      "{} ticks at {:.0f} Hz, {} deadlines skipped\n"
      "lateness   median {:.0f} us, 99.9 % {:.0f} us, longest {:.0f} us, above 1 ms {:.3f} %\n"
      "tick time  median {:.1f} us, 99.9 % {:.1f} us, longest {:.0f} us\n"
      "watchdog  ",
      r.ticks, r.rate_hz, r.skipped, r.late_median_us, r.late_p999_us, r.late_longest_us,
      100 * r.late_above_1ms, r.tick_median_us, r.tick_p999_us, r.tick_longest_us);
  bool any = r.guarded > 0;
  for (std::size_t i = 1; i < r.trips.size(); ++i) {
    if (r.trips[i] == 0) continue;
    any = true;
    out += fmt::format(" {} x {}", r.trips[i], kTripNames[i]);
  }
  if (r.guarded > 0) out += fmt::format(" {} x released by the guard", r.guarded);
  if (!any) out += " never acted";
  out += fmt::format("\npassivity  {:.2f} N mm taken out\n", r.removed);
  out += histogram_text(r.histogram);
  for (const std::string& w : r.warnings) out += "warning: " + w + '\n';
  return out;
}

}  // namespace palpate::haptics
