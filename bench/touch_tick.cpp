// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "haptics/realtime.hpp"
#include "haptics/slide.hpp"
#include "touch_figures.hpp"

namespace palpate::bench {

using namespace haptics;

namespace {

struct Times {
  double median = 0, p999 = 0, longest = 0;
};

Times summary(std::vector<double>& us) {
  std::sort(us.begin(), us.end());
  return {us[us.size() / 2], us[us.size() - us.size() / 1000 - 1], us.back()};
}

// The way over the head, walked beforehand; nan marks where the tool starts again.
std::vector<Vec3> way_over(const TouchModel& model, std::size_t ticks) {
  scenes::SlideOptions options;
  options.spacing = 10;
  const TickSetup setup = make_tick_setup(model, unlimited(), scenes::elastic_only());
  std::vector<Vec3> way;
  scenes::walk_over_head(setup, options,
                         [&](const TickOutput&, const TickInput& input, const TickState& state) {
                           if (state.ticks == 1) way.emplace_back(Vec3::Constant(std::nan("")));
                           way.push_back(input.position);
                         });
  if (way.size() > ticks) way.resize(ticks);
  return way;
}

}  // namespace

namespace {

struct Timed {
  std::vector<double> touch, empty, alone;  // [us]
  double sum = 0;                           // of the forces, so that no tick is optimised away
};

// Arithmetic in registers for about as long as a tick: what the machine adds to any work of that
// length (interrupts, other programs' use of the core).
double spin(double seed) {
  for (int i = 0; i < 300; ++i) seed = std::sqrt(seed + 1);
  return seed;
}

Timed time_along(const TickSetup& setup, const std::vector<Vec3>& way) {
  using Clock = std::chrono::steady_clock;
  Timed timed;
  timed.touch.reserve(way.size());
  timed.empty.reserve(way.size());
  timed.alone.reserve(way.size());
  TickState state;
  for (const Vec3& p : way) {
    if (!p.allFinite()) {
      state = {};
      continue;
    }
    TickInput input;
    input.position = p;
    const auto a = Clock::now();
    const TickOutput out = tick(setup, input, state);
    const auto b = Clock::now();
    timed.sum += out.force.x();
    const auto c = Clock::now();
    timed.sum += spin(out.force.x() + 100);
    const auto d = Clock::now();
    if (!out.in_contact) continue;
    timed.touch.push_back(std::chrono::duration<double, std::micro>(b - a).count());
    timed.empty.push_back(std::chrono::duration<double, std::micro>(c - b).count());
    timed.alone.push_back(std::chrono::duration<double, std::micro>(d - c).count());
  }
  return timed;
}

}  // namespace

void time_ticks(const TouchScene& scene, std::size_t ticks, int priority, Table& table) {
  const TickSetup setup = make_tick_setup(scene.model, *limits_of("falcon"));
  const std::vector<Vec3> way = way_over(scene.model, ticks);
  Timed timed;
  std::vector<double> best;  // [us] of three passes: what the machine itself adds falls out
  bool refused = false;
  // As the loop runs: with its priority, where the system grants it.
  std::thread([&] {
    if (priority > 0)
      for (const std::string& line : ask_for_realtime(priority))
        refused = refused || line.find("priority") != std::string::npos;
    timed = time_along(setup, way);
    best = timed.touch;
    for (int pass = 1; pass < 3; ++pass) {
      const std::vector<double> again = time_along(setup, way).touch;
      for (std::size_t i = 0; i < best.size(); ++i) best[i] = std::min(best[i], again[i]);
    }
  }).join();
  const Times t = summary(timed.touch), e = summary(timed.empty), b = summary(best),
              m = summary(timed.alone);
  table.add(fmt::format("tick, {} triangles", scene.model.mesh.triangles.size()),
            "median 2 us, 99.9 % 10 us",
            fmt::format(
                "median {:.2f}  99.9 % {:.2f}  longest {:.0f} us; empty {:.2f} {:.2f} "
                "{:.0f}; arithmetic alone {:.2f} {:.2f} {:.0f}; best of three passes {:.2f} {:.2f} "
                "{:.0f}; "
                "{} ticks in contact, {}",
                t.median, t.p999, t.longest, e.median, e.p999, e.longest, m.median, m.p999,
                m.longest, b.median, b.p999, b.longest, timed.touch.size(),
                priority > 0 && !refused ? fmt::format("SCHED_FIFO {}", priority) : "no priority"),
            t.median <= 2 && t.p999 <= 10 && std::isfinite(timed.sum));
}

void measure_slide(const TouchScene& scene, Table& table) {
  const scenes::SlideResult r = scenes::slide_over_head(scene.model);
  const double metres = 1e-4 * static_cast<double>(r.ticks);
  table.add(
      fmt::format("slide, {}", scene.name), "map's change + 0.05 N",
      fmt::format("{:.4f} N beyond it; largest change {:.3f} N, depth {:.3f} mm beyond the "
                  "tool's; {:.1f} m, {:.1f} % settling, {} lifts (worst at {:.0f} {:.0f} {:.0f})",
                  r.excess, r.change, r.depth_jump, metres,
                  100.0 * static_cast<double>(r.settling) / static_cast<double>(r.ticks), r.lifts,
                  r.worst_excess.x(), r.worst_excess.y(), r.worst_excess.z()),
      r.excess <= 0.05);
  table.add(fmt::format("direction, {}", scene.name), "2 deg a tick off creases",
            fmt::format("{:.2f} deg ({} of {} ticks above 2); with creases {:.1f} deg; {:.0f} % is "
                        "free of creases (worst at {:.0f} {:.0f} {:.0f})",
                        r.turn_smooth, r.turns, r.smooth, r.turn_anywhere,
                        100.0 * static_cast<double>(r.smooth) / static_cast<double>(r.ticks),
                        r.worst_turn.x(), r.worst_turn.y(), r.worst_turn.z()),
            r.turn_smooth <= 2);
}

}  // namespace palpate::bench
