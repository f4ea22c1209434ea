// SPDX-License-Identifier: GPL-3.0-or-later
// The loop in real time while a client reads its state from a TCP socket at display rate.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "haptics/loop.hpp"
#include "haptics/realtime.hpp"
#include "haptics/simulated_hand.hpp"
#include "touch_figures.hpp"

namespace palpate::bench {

using namespace haptics;

namespace {

/// A server that sends the latest tick 60 times a second, and a client that reads it.
class LiveReader {
 public:
  explicit LiveReader(const TouchCycle& cycle) : cycle_(cycle) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(at);
    auto* address = reinterpret_cast<sockaddr*>(&at);
    ::bind(listener_, address, size);
    ::listen(listener_, 1);
    ::getsockname(listener_, address, &size);
    client_socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ::connect(client_socket_, address, size);
    server_socket_ = ::accept(listener_, nullptr, nullptr);
    server_ = std::thread([this] { serve(); });
    client_ = std::thread([this] { read(); });
  }
  ~LiveReader() {
    stop_ = true;
    server_.join();
    client_.join();
    ::close(client_socket_);
    ::close(listener_);
  }
  LiveReader(const LiveReader&) = delete;
  LiveReader& operator=(const LiveReader&) = delete;
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

 private:
  void serve() {
    while (!stop_) {
      const CycleSnapshot s = cycle_.latest();
      if (::send(server_socket_, static_cast<const void*>(&s), sizeof(s), MSG_NOSIGNAL) < 0) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(16));
    }
    ::close(server_socket_);
  }
  void read() {
    char buffer[4096];
    for (;;) {
      const ssize_t n = ::recv(client_socket_, buffer, sizeof(buffer), 0);
      if (n <= 0) return;
      bytes_ += static_cast<std::uint64_t>(n);
    }
  }
  const TouchCycle& cycle_;
  int listener_ = -1, server_socket_ = -1, client_socket_ = -1;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> bytes_{0};
  std::thread server_, client_;
};

/// A thread that does nothing but sleep to the same deadlines, half a period apart: what the
/// machine makes late, whatever the loop does.
class BareSleeper {
 public:
  explicit BareSleeper(int priority) : thread_([this, priority] { run(priority); }) {}
  ~BareSleeper() { stop(); }
  BareSleeper(const BareSleeper&) = delete;
  BareSleeper& operator=(const BareSleeper&) = delete;
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const DurationHistogram& lateness() const { return lateness_; }
  [[nodiscard]] double late_above_1ms() const {
    const auto all = static_cast<double>(lateness_.total() + skipped_);
    return static_cast<double>(late_ + skipped_) / all;
  }

 private:
  void run(int priority) {
    constexpr std::int64_t kPeriod = 1'000'000;  // [ns]
    if (priority > 0) (void)ask_for_realtime(priority);
    sharpen_timer();
    std::int64_t deadline = monotonic_ns() + 3 * kPeriod / 2;
    while (!stop_) {
      sleep_until_ns(deadline);
      const std::int64_t now = monotonic_ns();
      lateness_.add(now - deadline);
      late_ += now - deadline > kPeriod;
      for (deadline += kPeriod; deadline <= now; deadline += kPeriod) ++skipped_;
    }
  }
  DurationHistogram lateness_;
  std::uint64_t late_ = 0, skipped_ = 0;  // skipped deadlines count as late, as in LoopReport
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// [jiffy] of all processors since the machine started: what a virtual machine's host gave to
/// others while this one wanted to run, and everything.
struct ProcessorTime {
  double stolen = 0, all = 0;
};
ProcessorTime processor_time() {
  std::ifstream file("/proc/stat");
  std::string word;
  file >> word;
  ProcessorTime t;
  constexpr int kSteal = 7, kColumns = 8;  // the columns after them are part of the first ones
  double value = 0;
  for (int i = 0; i < kColumns && file >> value; ++i) {
    t.all += value;
    if (i == kSteal) t.stolen = value;
  }
  return t;
}

/// Judges nothing: what of the lateness is the machine's.
void compare_with_bare(const LoopReport& loop, const BareSleeper& bare, const ProcessorTime& before,
                       Table& table) {
  table.note(
      fmt::format("  a thread that only sleeps, beside it: {:.3f} % late by > 1 ms; median "
                  "{:.0f}  99.9 % {:.0f}  longest {:.0f} us",
                  100 * bare.late_above_1ms(), bare.lateness().quantile_us(0.5),
                  bare.lateness().quantile_us(0.999), bare.lateness().longest_us()));
  const ProcessorTime now = processor_time();
  const double all = now.all - before.all;
  table.note(fmt::format(
      "  the loop beyond it: {:+.3f} % late by > 1 ms; median {:+.0f}  99.9 % {:+.0f}  longest "
      "{:+.0f} us; {}",
      100 * (loop.late_above_1ms - bare.late_above_1ms()),
      loop.late_median_us - bare.lateness().quantile_us(0.5),
      loop.late_p999_us - bare.lateness().quantile_us(0.999),
      loop.late_longest_us - bare.lateness().longest_us(),
      all > 0 ? fmt::format("the host took {:.2f} % of the processors' time (steal)",
                            100 * (now.stolen - before.stolen) / all)
              : std::string("the machine does not tell its steal time")));
}

void print_histogram(const DurationHistogram& histogram, Table& table) {
  constexpr int kOctave = 8;  // buckets
  for (int i = 0; i + kOctave < DurationHistogram::kBuckets; i += kOctave) {
    std::uint64_t count = 0;
    for (int k = 1; k <= kOctave; ++k) count += histogram.count(i + k);
    if (i == 0) count += histogram.count(0);
    if (count > 0)
      table.note(
          fmt::format("  late by less than {:>9.1f} us: {}", histogram.upper_us(i + 8), count));
  }
}

}  // namespace

void keep_time(const TouchScene& scene, int seconds, int priority, Table& table) {
  const TickSetup setup = make_tick_setup(scene.model, *limits_of("falcon"));
  SimulatedHandOptions hand_options;
  hand_options.repeat = true;
  hand_options.limits = setup.limits;
  SimulatedHand hand(random_walk(scene.model, 1, 60, 150), hand_options);
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("palpate_bench_{}.touch", ::getpid());
  Recorder recorder(file, setup, hand.info().name);
  TouchCycle cycle(setup, hand, Workspace{}, {}, &recorder);
  LoopOptions options;
  options.priority = priority;
  TouchLoop loop(cycle, options);
  std::uint64_t bytes = 0;
  const ProcessorTime before = processor_time();
  loop.start();
  BareSleeper bare(priority);
  {
    LiveReader reader(cycle);
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
    bytes = reader.bytes();
  }
  bare.stop();
  loop.stop();
  recorder.finish();
  std::filesystem::remove(file);
  const LoopReport r = loop.report();
  const bool refused = std::any_of(r.warnings.begin(), r.warnings.end(), [](const auto& line) {
    return line.find("real-time priority") != std::string::npos;
  });
  table.add(fmt::format(
                "loop, {} s at 1 kHz, {}", seconds,
                priority > 0 && !refused ? fmt::format("SCHED_FIFO {}", priority) : "no priority"),
            "0.1 % late by > 1 ms",
            fmt::format("{:.3f} % late by > 1 ms; median {:.0f}  99.9 % {:.0f}  longest {:.0f} us; "
                        "tick {:.1f} {:.1f} {:.0f} us; {} skipped; client read {} KiB; {} ticks "
                        "recorded, {} dropped",
                        100 * r.late_above_1ms, r.late_median_us, r.late_p999_us, r.late_longest_us,
                        r.tick_median_us, r.tick_p999_us, r.tick_longest_us, r.skipped,
                        bytes / 1024, recorder.written(), recorder.dropped()),
            r.late_above_1ms <= 1e-3);
  compare_with_bare(r, bare, before, table);
  for (const std::string& warning : r.warnings) table.note(warning);
  print_histogram(loop.lateness(), table);
}

}  // namespace palpate::bench
