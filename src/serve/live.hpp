// SPDX-License-Identifier: GPL-3.0-or-later
// Between the touch loop and the pages that look on: state out, commands in. The loop is read
// through its lock-free exchange only; nothing here can hold it up.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "haptics/loop.hpp"
#include "serve/live_protocol.hpp"
#include "serve/pointer.hpp"

namespace palpate::serve {

/// Where the pointer's tool stands for a picked point: sphere centre = point + (R - depth) normal.
struct PressPlace {
  Vec3 point = Vec3::Zero();    ///< [mm] nearest point of the skin
  Vec3 normal = Vec3::UnitZ();  ///< [-] outward, blended vertex normals
  [[nodiscard]] Vec3 center(double tool_radius, double depth) const {
    return point + (tool_radius - depth) * normal;
  }
};
/// Nothing where the skin is farther than 20 mm from `picked`.
[[nodiscard]] std::optional<PressPlace> press_place(const haptics::TouchModel& model,
                                                    const Vec3& picked);
/// Blended curve of the map under the tool, up to 1.2 times the travel at the highest force, or to
/// the present depth where that is more.
[[nodiscard]] TouchedCurve touched_curve(const haptics::TouchModel& model,
                                         const haptics::TickOutput& out);

/// What stays the same while a head is served; sent first to each page.
struct LiveFacts {
  std::string head_name;  ///< file name, for the title
  std::vector<std::string> warnings;
  std::string recording;                   ///< file, empty for none
  std::optional<SkinRegion> look_at = {};  ///< where pages look first; nothing: the face
};

/// All members are for one thread: the server's.
class LiveTouch {
 public:
  /// @param loop     gives the health; started by the caller
  /// @param pointer  moved by press commands; null where a device does the touching
  LiveTouch(haptics::TouchCycle& cycle, const haptics::TouchLoop& loop, PointerDevice* pointer,
            const haptics::Recorder* recorder, LiveFacts facts);

  [[nodiscard]] nlohmann::json hello() const;
  [[nodiscard]] nlohmann::json health() const;
  [[nodiscard]] std::string state() const;

  /// @param client  number of the connection. A touch belongs to who began it; another's moves are
  ///                passed over until it begins one itself.
  void apply(const Command& command, std::uint64_t client);
  /// The connection ended: its touch is lifted.
  void forget(std::uint64_t client);
  /// Lifts a touch whose page has been silent for more than 3 s. Call at display rate.
  void keep();

 private:
  void press(const Command& command, std::uint64_t client);
  void lift();
  [[nodiscard]] Vec3 to_user(const Vec3& head) const;

  haptics::TouchCycle& cycle_;
  const haptics::TouchLoop& loop_;
  PointerDevice* pointer_;
  const haptics::Recorder* recorder_;
  LiveFacts facts_;
  nlohmann::json regions_;        // found once: a new connection must cost little
  haptics::Workspace workspace_;  // the pointer's
  PressPlace place_;
  std::uint64_t owner_ = 0;  // 0: nobody presses
  std::int64_t heard_ns_ = 0;
};

}  // namespace palpate::serve
