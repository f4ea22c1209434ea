// SPDX-License-Identifier: GPL-3.0-or-later
// The touch loop for a while at 1 kHz with a simulated hand, a recorder and a reader at display
// rate: how late it was and how long a tick took.
//   bench_loop [seconds] [real-time priority, 0 for none]
#include <fmt/core.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include "haptics/loop.hpp"
#include "haptics/scenes.hpp"
#include "haptics/simulated_hand.hpp"

int main(int argc, char** argv) {
  using namespace palpate::haptics;
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 10;
  LoopOptions options;
  if (argc > 2) options.priority = std::atoi(argv[2]);

  const TouchModel model = make_touch_model(scenes::bumpy_head(112));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  SimulatedHandOptions hand_options;
  hand_options.repeat = true;
  hand_options.limits = setup.limits;
  SimulatedHand hand(random_walk(model, 1, 60, 150), hand_options);
  const auto file = std::filesystem::temp_directory_path() / "palpate_bench_loop.touch";
  Recorder recorder(file, setup, hand.info().name);
  TouchCycle cycle(setup, hand, Workspace{}, {}, &recorder);
  TouchLoop loop(cycle, options);
  loop.start();
  std::size_t frames = 0, in_contact = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(16));
    ++frames;
    in_contact += cycle.latest().out.in_contact;
  }
  loop.stop();
  recorder.finish();
  fmt::print("{}{} snapshots read, {} in contact; {} ticks recorded, {} dropped\n",
             text(loop.report()), frames, in_contact, recorder.written(), recorder.dropped());
  std::filesystem::remove(file);
}
