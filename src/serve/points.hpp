// SPDX-License-Identifier: GPL-3.0-or-later
// What a page may ask about the landmarks (docs/formats.md): keep moved points in a file, or fit
// the skull with them.
#pragma once
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "core/types.hpp"

namespace palpate::serve {

struct PointsRequest {
  enum class Kind {
    save,  ///< write the points to the file
    run,   ///< landmarks and fit anew, with the points
    stop,  ///< end the run that is under way
  };
  Kind kind = Kind::stop;
  std::map<std::string, Vec3> moved;  ///< [mm] head frame; save and run only
  bool replace = false;               ///< save: also over a file of somebody else
};

inline constexpr std::size_t kMostPoints = 64;

/// {"do": "save", "points": {"nose_tip": [x, y, z]}, "replace": false}, {"do": "run", "points":
/// {...}} or {"do": "stop"}, and nothing else.
/// @param names  of the points that there are
/// @throws InputError  says what is wrong, in one line: not JSON, nested too deep, another key, a
///                     name that is not in `names`, more than 64 points, a number that is not
///                     finite or beyond 2000 mm
[[nodiscard]] PointsRequest parse_points_request(std::string_view text,
                                                 const std::set<std::string>& names);

/// Whether a name can stand in a line of text: 1 to 40 of a to z, 0 to 9 and _.
[[nodiscard]] bool is_plain_name(std::string_view name);

}  // namespace palpate::serve
