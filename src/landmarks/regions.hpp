// SPDX-License-Identifier: GPL-3.0-or-later
// The regions of the skin for maps, tables and studies (docs/method/regions.md).
#pragma once
#include <vector>

#include "core/landmarks.hpp"
#include "core/regions.hpp"

namespace palpate::landmarks {

/// @param points     [mm] head frame
/// @param normals    [-] outward, one per point
/// @param landmarks  [mm] head frame: at least those of detect_landmarks
/// @return one region per point; the same point gets the same region whatever the mesh
[[nodiscard]] std::vector<SkinRegion> skin_regions(const std::vector<Vec3>& points,
                                                   const std::vector<Vec3>& normals,
                                                   const LandmarkSet& landmarks);

}  // namespace palpate::landmarks
