// SPDX-License-Identifier: GPL-3.0-or-later
// From the statistical face's guess of a point to where this head's surface has it.
#pragma once
#include <optional>

#include "landmarks/relief.hpp"

namespace palpate::landmarks {

/// All in the head frame, [mm]; the guess is returned where the surface shows nothing better.
[[nodiscard]] Vec3 sharpen_nose_tip(const Relief& relief, const Vec3& guess);

}  // namespace palpate::landmarks
