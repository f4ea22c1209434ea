// SPDX-License-Identifier: GPL-3.0-or-later
// From the statistical face's guess of a point to where this head's surface has it.
#pragma once
#include <optional>

#include "landmarks/relief.hpp"

namespace palpate::landmarks {

/// All points in the head frame, [mm]; the guess is returned where the surface shows nothing
/// better.
[[nodiscard]] Vec3 sharpen_nose_tip(const Relief& relief, const Vec3& guess);

/// The nose corner (alar curvature point): the foot of the nose wing where the nose is widest.
/// @param relief  of the nose's surroundings, steps of at most 0.5 mm
[[nodiscard]] Vec3 sharpen_nose_corner(const Relief& relief, const Vec3& guess);
/// The outer corner of an eye that is open in the scan (a hole or a socket between the lids): the
/// opening's end away from the nose. Nothing where the eye is closed or the opening is no eye's.
/// @param scan    the scan itself, holes and all
/// @param skin    the closed surface
/// @param inner,outer  the guesses; their x gives the side
[[nodiscard]] std::optional<Vec3> open_eye_corner(const surface::SurfaceQuery& scan,
                                                  const surface::SurfaceQuery& skin,
                                                  const HeadFrame& frame, const Vec3& inner,
                                                  const Vec3& outer);

}  // namespace palpate::landmarks
