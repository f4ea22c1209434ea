// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/terminal_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>
#include <string_view>

namespace palpate::app {
namespace {

std::atomic<bool> stop_asked{false};

/// The first Ctrl-C asks the run to stop at its next step; the second ends the process at once,
/// with what a signal's handler may use.
void on_interrupt(int signal) {
  if (!stop_asked.exchange(true)) return;
  constexpr std::string_view kSaid =
      "\npalpate: stopped at once by the second interrupt; give the same command to begin again\n";
  const auto written = write(STDERR_FILENO, kSaid.data(), kSaid.size());
  static_cast<void>(written);  // where nobody can hear it, there is nothing more to say
  std::_Exit(128 + signal);
}

std::string clock_time(double seconds) {
  const int s = static_cast<int>(seconds + 0.5);
  return s < 60 ? fmt::format("{} s", s) : fmt::format("{} min {:02} s", s / 60, s % 60);
}

constexpr double kWorthALine = 0.5;  // [s] shorter steps leave no line behind

class StageLine {
 public:
  explicit StageLine(bool terminal) : terminal_(terminal) {}

  void operator()(std::string_view stage, double fraction) {
    const auto now = std::chrono::steady_clock::now();
    if (stage != stage_) {
      finish();
      stage_ = stage;
      start_ = shown_ = now;
      if (terminal_) draw(fraction, 0);
    } else if (terminal_ && now - shown_ > std::chrono::milliseconds(200)) {
      shown_ = now;
      draw(fraction, elapsed(now));
    }
    if (fraction >= 1) finish();
  }

 private:
  double elapsed(std::chrono::steady_clock::time_point now) const {
    return std::chrono::duration<double>(now - start_).count();
  }
  void draw(double fraction, double seconds) const {
    std::string left;
    if (fraction > 0.02 && seconds > 1)
      left = ", " + clock_time(seconds * (1 - fraction) / fraction) + " left";
    fmt::print(stderr, "\r\033[K{:<28} {:3.0f} %{}", stage_, 100 * fraction, left);
    std::fflush(stderr);
  }
  void finish() {
    if (stage_.empty()) return;
    const double seconds = elapsed(std::chrono::steady_clock::now());
    if (seconds < kWorthALine) {
      if (terminal_) fmt::print(stderr, "\r\033[K");
      stage_.clear();
      return;
    }
    fmt::print(stderr, "{}{:<28} {}\n", terminal_ ? "\r\033[K" : "", stage_, clock_time(seconds));
    stage_.clear();
  }

  bool terminal_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_, shown_;
};

/// Every stage's begin and end, and what lies between at most ten times a second.
class PlainLines {
 public:
  void operator()(std::string_view stage, double fraction) {
    const auto now = std::chrono::steady_clock::now();
    if (fraction > 0 && fraction < 1 && now - told_ < std::chrono::milliseconds(100)) return;
    told_ = now;
    fmt::print("@ {:.3f} {}\n", fraction, stage);
    std::fflush(stdout);
  }

 private:
  std::chrono::steady_clock::time_point told_{};
};

void listen_to_signals() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace

std::unique_ptr<Progress> make_line_progress() {
  listen_to_signals();
  return std::make_unique<Progress>(PlainLines(), &stop_asked);
}

std::unique_ptr<Progress> make_terminal_progress(bool quiet) {
  listen_to_signals();
  if (quiet) return std::make_unique<Progress>(Progress::Listener{}, &stop_asked);
  return std::make_unique<Progress>(StageLine(isatty(STDERR_FILENO) == 1), &stop_asked);
}

}  // namespace palpate::app
