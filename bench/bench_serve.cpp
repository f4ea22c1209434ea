// SPDX-License-Identifier: GPL-3.0-or-later
// The touch loop while strangers flood its server: 200 connections that send malformed frames, from
// a process of their own. Prints the tick times before, during and after.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "haptics/scenes.hpp"
#include "haptics/simulated_hand.hpp"
#include "serve/raw_client.hpp"
#include "serve/server.hpp"

namespace {

using namespace palpate;
using Clock = std::chrono::steady_clock;

/// Runs in a child: keeps `connections` open and sends one malformed frame after the other.
int flood(unsigned short port, int frames, int connections) {
  std::mt19937_64 random(11);
  std::vector<std::unique_ptr<serve::raw::Client>> crowd(static_cast<std::size_t>(connections));
  for (auto& c : crowd) {
    c = std::make_unique<serve::raw::Client>(port);
    if (!c->upgrade()) return 1;
  }
  for (int i = 0; i < frames; ++i) {
    auto& c = crowd[static_cast<std::size_t>(i) % crowd.size()];
    c->send(serve::raw::malformed(random));
    c = std::make_unique<serve::raw::Client>(port);
    if (!c->upgrade()) return 1;
  }
  return 0;
}

/// Counts of the histogram in an interval: what was added since `before`.
struct Interval {
  std::array<std::uint64_t, haptics::DurationHistogram::kBuckets> before{};
  const haptics::DurationHistogram& h;
  explicit Interval(const haptics::DurationHistogram& histogram) : h(histogram) {
    for (int i = 0; i < h.kBuckets; ++i) before[static_cast<std::size_t>(i)] = h.count(i);
  }
  /// [us] by straight interpolation in the bucket.
  [[nodiscard]] double quantile(double fraction) const {
    double total = 0;
    const auto added = [&](int i) {
      return static_cast<double>(h.count(i) - before[static_cast<std::size_t>(i)]);
    };
    for (int i = 0; i < h.kBuckets; ++i) total += added(i);
    double seen = 0;
    for (int i = 0; i < h.kBuckets; ++i) {
      if (added(i) > 0 && seen + added(i) >= fraction * total)
        return h.lower_us(i) +
               (fraction * total - seen) / added(i) * (h.upper_us(i) - h.lower_us(i));
      seen += added(i);
    }
    return 0;
  }
};

void print(const char* when, const Interval& tick, const Interval& late, double seconds) {
  fmt::print(
      "{:<8} {:6.1f} s   tick median {:6.2f} us, 99.9 % {:7.2f} us   late 99.9 % {:8.1f} us\n",
      when, seconds, tick.quantile(0.5), tick.quantile(0.999), late.quantile(0.999));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int frames = 100'000, connections = 200;
  haptics::LoopOptions options;
  CLI::App program("the touch loop while its server is flooded with malformed frames");
  program.add_option("frames", frames, "in all; 100000")->check(CLI::Range(1, 100'000'000));
  program.add_option("connections", connections, "200")->check(CLI::Range(1, 900));
  program.add_option("priority", options.priority,
                     "real-time priority of the loop, 0 for none; 80");
  CLI11_PARSE(program, argc, argv);

  const haptics::TouchModel model = haptics::make_touch_model(haptics::scenes::bumpy_head(112));
  const haptics::TickSetup setup = haptics::make_tick_setup(model, *haptics::limits_of("falcon"));
  haptics::SimulatedHandOptions hand_options;
  hand_options.repeat = true;
  hand_options.limits = setup.limits;
  haptics::SimulatedHand hand(haptics::random_walk(model, 1, 20, 150), hand_options);
  haptics::TouchCycle cycle(setup, hand, haptics::Workspace{});
  haptics::TouchLoop loop(cycle, options);
  serve::LiveTouch live(cycle, loop, nullptr, nullptr, {"head.glb", {}, ""});
  serve::ServerOptions server_options;
  server_options.max_connections = static_cast<std::size_t>(connections) + 64;

  // The child is made before the threads; it learns the port through a pipe.
  int tell[2];
  if (pipe(tell) != 0) return 1;
  const pid_t child = fork();
  if (child == 0) {
    unsigned short port = 0;
    if (read(tell[0], &port, sizeof port) != static_cast<ssize_t>(sizeof port)) _exit(1);
    _exit(flood(port, frames, connections));
  }
  serve::Server server(server_options, serve::load_page(""), live);
  loop.start();
  serve::raw::Client page(server.port());
  if (!page.upgrade()) return 1;
  std::atomic<bool> done{false};
  // A pong now and then, as a browser answers: the server drops a page that is silent for 20 s.
  std::thread reader([&] {
    constexpr unsigned kPong = 10;
    auto next = Clock::now();
    while (!done && page.open()) {
      (void)page.receive(100);
      if (Clock::now() < next) continue;
      page.send(serve::raw::frame("", kPong));
      next += std::chrono::seconds(3);
    }
  });
  const auto watch = [&](const char* when, const auto& work) {
    const Interval tick(loop.tick_time()), late(loop.lateness());
    const auto start = Clock::now();
    work();
    print(when, tick, late, std::chrono::duration<double>(Clock::now() - start).count());
    return tick.quantile(0.999);
  };
  const auto rest = [] { std::this_thread::sleep_for(std::chrono::seconds(20)); };
  const double idle = watch("idle", rest);
  int status = 0;
  const double flooded = watch("flooded", [&] {
    const unsigned short port = server.port();
    if (write(tell[1], &port, sizeof port) < 0) std::abort();
    waitpid(child, &status, 0);
  });
  watch("after", rest);
  const serve::Server::Counts counts = server.counts();
  constexpr double kMore = 1.2;  // [-] asked: within 20 % of idle
  fmt::print(
      "{} {} frames over {} connections, {} refused, flood {}; 99.9 % {:+.0f} % against idle\n",
      flooded <= kMore * idle ? "  " : "!!", frames, connections, counts.refused,
      status == 0 ? "sent" : "failed", 100 * (flooded / idle - 1));
  fmt::print("page still {}\n", page.open() ? "served" : "lost");
  done = true;
  reader.join();
}
