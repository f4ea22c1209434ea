// SPDX-License-Identifier: GPL-3.0-or-later
// The landmarks as a small text that people edit: one point a line.
#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "core/landmarks.hpp"

namespace palpate::app {

/// "found nose_tip 0.1 12.5 93.2 0.84" per point, with a word of help on top. A line whose first
/// word was changed to "fixed" holds from then on; the others are found anew.
/// @param landmarks  scan frame, [mm]     @param unit_mm  the file is in the scan's own unit
[[nodiscard]] std::string landmark_text(const LandmarkSet& landmarks, double unit_mm);

/// The fixed points, scan's own unit. `name` is for messages.
/// @throws InputError  names the line
[[nodiscard]] std::map<std::string, Vec3> parse_landmark_text(const std::string& text,
                                                              const std::string& name);

}  // namespace palpate::app
