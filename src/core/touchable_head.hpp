// SPDX-License-Identifier: Apache-2.0
// The product: a head that can be felt, as `head.glb` stores it.
#pragma once
#include <nlohmann/json.hpp>

#include "core/landmarks.hpp"
#include "core/map_spread.hpp"
#include "core/skull.hpp"
#include "core/stiffness_map.hpp"
#include "core/surface_mesh.hpp"

namespace palpate {

struct TouchableHead {
  SurfaceMesh skin;       ///< the user's own vertices in the scan's own numbers and order
  double unit_mm = 1;     ///< [mm] per unit of the scan
  HeadFrame frame;        ///< scan in mm -> head frame
  LandmarkSet landmarks;  ///< scan frame, [mm]
  SurfaceMesh skull;      ///< scan frame, [mm]
  std::vector<SkullRegion> skull_region;
  std::vector<double> skull_spread;  ///< [mm] one per skull vertex, or empty: SkullFit::spread
  std::vector<DepthRow> depths;
  StiffnessMap map;  ///< one row per skin vertex
  MapSpread spread;  ///< of the map; may be empty
  /// One per skin vertex: 1 where its result rests on skin that was completed, not scanned
  /// (docs/method/landmarks.md). Empty where nothing was completed.
  std::vector<std::uint8_t> completed;
  nlohmann::json provenance;  ///< input hash, version, every option, fit and mesh statistics
  nlohmann::json run;         ///< timings and thread count: all that may differ between equal runs
};

}  // namespace palpate
