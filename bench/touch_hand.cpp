// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "haptics/press.hpp"
#include "touch_figures.hpp"

namespace palpate::bench {

using namespace haptics;

namespace {

struct Job {
  DeviceLimits device;
  SkinRegion region;
  bool
      bare;  // without friction, drag and rate: a harder test of the energy; a hand on skin without
             // friction has nothing to come to rest on, so that its rest is shown, not judged
  scenes::PressResult result;
};

void run_all(const TouchModel& model, double seconds, std::vector<Job>& jobs) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      Job& j = jobs[i];
      j.result = scenes::press(model, j.device, j.bare ? scenes::bare() : scenes::stiffest(),
                               scenes::press_path(model, j.region, j.device), seconds);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
    threads.emplace_back(work);
  for (std::thread& t : threads) t.join();
}

}  // namespace

void press_everywhere(const TouchScene& scene, double seconds, Table& table) {
  std::vector<Job> jobs;
  for (const DeviceLimits& device : known_devices())
    for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r) {
      const auto region = static_cast<SkinRegion>(r);
      const auto& all = scene.model.region;
      if (std::find(all.begin(), all.end(), region) == all.end()) continue;
      for (const bool bare : {false, true}) jobs.push_back({device, region, bare, {}});
    }
  run_all(scene.model, seconds, jobs);
  for (const DeviceLimits& device : known_devices())
    for (const bool bare : {false, true}) {
      scenes::PressResult sum;
      double least_contact = 1;
      SkinRegion worst = SkinRegion::other;
      std::size_t regions = 0;
      sum.work = -1e300;
      for (const Job& j : jobs) {
        if (j.device.name != device.name || j.bare != bare) continue;
        ++regions;
        if (j.result.tremor > sum.tremor) worst = j.region;
        sum.tremor = std::max(sum.tremor, j.result.tremor);
        sum.work = std::max(sum.work, j.result.work);
        sum.given = std::max(sum.given, j.result.given);
        sum.force = std::max(sum.force, j.result.force);
        least_contact = std::min(least_contact, j.result.contact);
      }
      table.add(
          fmt::format("{}{}", device.name, bare ? ", elastic only" : ""),
          bare ? "work <= 0" : "work <= 0, std <= 0.02 N",
          fmt::format("work {:.2f} N mm, at most {:.4f} given in one contact; std {:.4f} N ({}); "
                      "up to {:.1f} N, {:.0f} % in contact; {} regions x {:.0f} s",
                      sum.work, sum.given, sum.tremor, name(worst), sum.force, 100 * least_contact,
                      regions, seconds),
          sum.work <= 1e-6 && (bare || sum.tremor <= 0.02));
    }
}

void replay_recording(const TouchScene& scene, double seconds, Table& table) {
  const auto file =
      std::filesystem::temp_directory_path() / fmt::format("palpate_replay_{}.touch", ::getpid());
  const TickSetup setup = make_tick_setup(scene.model, *limits_of("falcon"));
  SimulatedHandOptions o;
  o.limits = setup.limits;
  o.repeat = true;
  o.resolution = 0.06;
  SimulatedHand hand(random_walk(scene.model, 7, seconds, 150), o);
  const auto ticks = static_cast<std::uint64_t>(1000 * seconds);
  std::uint64_t touching = 0;
  {
    Recorder recorder(file, setup, hand.info().name);
    TouchCycle cycle(setup, hand, Workspace{}, {}, &recorder);
    for (std::uint64_t i = 0; i < ticks; ++i) {
      cycle.advance(static_cast<std::int64_t>(i + 1) * 1'000'000, 0);
      touching += cycle.latest().out.in_contact;
      // Far faster than life: the writer must follow.
      while (recorder.written() + recorder.dropped() + 4000 < i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    recorder.finish();
  }
  const auto bytes = std::filesystem::file_size(file);
  const ReplayResult r = replay(read_recording(file), scene.model);
  std::filesystem::remove(file);
  table.add(fmt::format("replay of {:.0f} s", seconds), "bit-identical",
            fmt::format("{} of {} ticks differ; {} in contact; {:.1f} bytes a tick", r.different,
                        r.ticks, touching, static_cast<double>(bytes) / static_cast<double>(ticks)),
            r.different == 0 && r.ticks == ticks);
}

}  // namespace palpate::bench
