// SPDX-License-Identifier: GPL-3.0-or-later
// Is it a face, and is there a head behind it?
#pragma once
#include <string>
#include <vector>

#include "landmarks/pose.hpp"

namespace palpate::landmarks {

/// @param given  the user's points: a refusal asks to check them, or for a nose tip
/// @param face_alone_will_do  a whole face, chin included, needs no head behind it
/// @return whether it is such a face alone
/// @throws InputError  one line: what was looked for and what was found instead
bool verify_face(const Skin& skin, const FaceSearch& found, const Pins& given,
                 bool face_alone_will_do, std::vector<std::string>& warnings);

/// [-] 0 to 1 from the misfit of the model points near the named one: 1 - misfit / 6 mm, where a
/// point that faces elsewhere counts as 6 mm.
[[nodiscard]] double confidence(const Skin& skin, const FacePose& pose, const std::string& name);

}  // namespace palpate::landmarks
