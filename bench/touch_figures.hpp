// SPDX-License-Identifier: GPL-3.0-or-later
// The measurements of bench_touch, one function a figure; each adds its rows to the table.
#pragma once
#include <string>

#include "haptics/touch_model.hpp"
#include "touch_table.hpp"

namespace palpate::bench {

struct TouchScene {
  std::string name;
  haptics::TouchModel model;  ///< 5 mm tool
  TouchableHead head;
};

/// Median and 99.9 % of one tick in contact, 5 mm tool sliding at 100 mm/s and 3 mm depth, with an
/// empty tick timed beside it, on a thread with SCHED_FIFO `priority` (0: none).
void time_ticks(const TouchScene& scene, std::size_t ticks, int priority, Table& table);
/// Jumps of force and direction on the same way.
void measure_slide(const TouchScene& scene, Table& table);
/// Random contacts in every region against core's coefficients at the nearest point, found by
/// trying all triangles.
void compare_with_map(const TouchScene& scene, int per_region, Table& table);
/// The loop in real time, with a recorder and a client that reads from a socket.
void keep_time(const TouchScene& scene, int seconds, int priority, Table& table);
/// The simulated hand on every region at each device's stiffest setting.
void press_everywhere(const TouchScene& scene, double seconds, Table& table);
/// A recording replayed.
void replay_recording(const TouchScene& scene, double seconds, Table& table);

}  // namespace palpate::bench
