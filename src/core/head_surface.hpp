// SPDX-License-Identifier: Apache-2.0
// The skin that the geometric and mechanical stages work on.
#pragma once
#include <cstdint>

#include "core/landmarks.hpp"
#include "core/regions.hpp"
#include "core/surface_mesh.hpp"

namespace palpate {

/// Closed, outward-oriented, isotropic working skin in the head frame, [mm].
struct HeadSurface {
  SurfaceMesh skin;
  std::vector<std::uint8_t> filled;  ///< one per point: 0 scan, 1 closed hole, 2 completed head
  LandmarkSet landmarks;             ///< head frame, [mm]
  std::vector<SkinRegion> region;    ///< one per point
  /// [rad] how far the mouth seems to be open, from the skin alone; 0: shut, as far as one sees
  double mouth_opening = 0;
};

}  // namespace palpate
