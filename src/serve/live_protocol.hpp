// SPDX-License-Identifier: GPL-3.0-or-later
// What goes over the live socket (docs/formats.md): commands in, state out; little-endian.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "haptics/cycle.hpp"

namespace palpate::serve {

inline constexpr std::uint32_t kLiveVersion = 1;
inline constexpr std::size_t kLongestCommand = 40;  ///< [byte]
inline constexpr std::size_t kCurveSamples = 41;

struct Command {
  enum class Kind : std::uint32_t { press = 1, lift = 2, aim = 3, pause = 4 };
  Kind kind = Kind::lift;
  bool begin = false;                     ///< press: a new touch, not a move of the last one
  Vec3 point = Vec3::Zero();              ///< press: [mm] picked on the skin, head frame
  double depth = 0;                       ///< press: [mm] below first contact; negative hovers
  SkinRegion region = SkinRegion::other;  ///< aim
  bool on = false;                        ///< pause
};
inline constexpr double kFarthest = 2000;  ///< [mm] largest coordinate of a command
inline constexpr double kDeepest = 60;     ///< [mm] largest depth of a command, either way

/// Nothing where the message is malformed: wrong length, unknown kind or flag, a number that is not
/// finite or out of range.
[[nodiscard]] std::optional<Command> parse_command(std::string_view bytes);
[[nodiscard]] std::string command_bytes(const Command& command);

/// The curve of the touched place: force at even steps of depth from 0 to `deepest`.
struct TouchedCurve {
  double deepest = 0;                         ///< [mm] 0 in free space
  std::array<double, kCurveSamples> force{};  ///< [N]
};
/// One message: 16 bytes of header (magic "PLST", version, count, 0) and `count` 64-bit floats.
[[nodiscard]] std::string state_bytes(const haptics::CycleSnapshot& snapshot,
                                      const TouchedCurve& curve);

}  // namespace palpate::serve
