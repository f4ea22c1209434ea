// SPDX-License-Identifier: Apache-2.0
// A recorded touch: what went into each tick and what came out (layout in docs/method/touch.md).
#pragma once
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "haptics/tick.hpp"

namespace palpate::haptics {

/// One tick as recorded.
struct RecordedTick {
  TickInput input;
  Vec3 force = Vec3::Zero();  ///< [N] put out, head frame
  double depth = 0;           ///< [mm]
  double map_force = 0;       ///< [N]
  std::int64_t time_ns = 0;   ///< monotonic clock
  std::int64_t late_ns = 0;   ///< after the deadline
  std::uint32_t buttons = 0;
  std::uint8_t trip = 0;  ///< as in cycle.hpp
  SkinRegion region = SkinRegion::other;
  bool in_contact = false;
};

/// Ticks without a gap, with the state before the first of them.
struct RecordedBlock {
  TickState state;
  std::uint64_t dropped = 0;  ///< ticks lost just before this block (the disk was too slow)
  std::vector<RecordedTick> ticks;
};

struct RecordingHeader {
  std::uint64_t fingerprint = 0;  ///< of the model
  double tool_radius = 0;         ///< [mm]
  DeviceLimits limits;
  std::string device;
  TickOptions options;
  double rate_hz = 1000;
};

struct Recording {
  RecordingHeader header;
  std::vector<RecordedBlock> blocks;
  std::string ending;  ///< empty, or why and where the rest of the file was left out

  [[nodiscard]] std::size_t tick_count() const;
};

/// Blocks whose check sum fails and all that follows are left out and told in `ending`: a recording
/// that a crash cut short is readable up to its last half second.
/// @throws InputError  not a recording, an unknown version, or a damaged header; names the file
[[nodiscard]] Recording read_recording(const std::filesystem::path& path);
/// The same from bytes; `name` appears in messages.
[[nodiscard]] Recording parse_recording(std::string_view bytes, const std::string& name);

struct ReplayResult {
  std::size_t ticks = 0;
  std::size_t different = 0;        ///< ticks whose force differs in a bit
  double largest_difference = 0;    ///< [N]
  std::size_t first_different = 0;  ///< index of the tick; meaningful where different > 0
  std::size_t gaps = 0;             ///< blocks that follow lost ticks
  std::size_t damped = 0;           ///< ticks whose force the passivity controller changed
  double removed = 0;               ///< [N mm] energy that it took out in these ticks
};
/// Runs the recorded inputs through tick() and compares the forces.
/// @throws InputError  the model is not the one that was touched
[[nodiscard]] ReplayResult replay(const Recording& recording, const TouchModel& model);

/// One line per tick: seconds, position, velocity, force, depth, contact, region, lateness. Numbers
/// have all their digits and a point, whatever the locale.
void write_csv(const Recording& recording, std::ostream& out);

}  // namespace palpate::haptics
