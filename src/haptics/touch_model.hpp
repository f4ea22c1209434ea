// SPDX-License-Identifier: Apache-2.0
// A touchable head made ready for the tick (docs/method/touch.md).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/touchable_head.hpp"
#include "haptics/contact_mesh.hpp"
#include "haptics/curve_table.hpp"

namespace palpate::haptics {

struct TouchModelOptions {
  /// [mm] radius of the tool sphere; 0 takes the map's. Another radius than the map's is allowed
  /// and warned about: the curves hold for the radius that pressed.
  double tool_radius = 0;
  /// [-] factor on both friction coefficients per vertex of the scan, >= 0; empty means 1.
  std::vector<double> friction;
};

/// Head frame, [mm]. Immutable once made; any number of ticks may read it.
struct TouchModel {
  ContactMesh mesh;
  CurveTable curves;                    ///< one row per point of the mesh
  double tool_radius = 0;               ///< [mm]
  double map_radius = 0;                ///< [mm] sphere that the map was computed with
  std::vector<SkinRegion> region;       ///< one per point
  std::vector<std::uint8_t> estimated;  ///< 1 where the curve was carried over from neighbours
  std::vector<float> friction;          ///< [-] factor per point, or empty
  HeadFrame frame;                      ///< scan [mm] -> head
  double unit_mm = 1;                   ///< [mm] per unit of the scan
  std::uint64_t fingerprint = 0;        ///< of everything above that a force depends on
  std::vector<std::string> warnings;

  /// Region of the corner with the largest weight.
  [[nodiscard]] SkinRegion region_at(const SurfacePoint& p) const;
};

/// Vertices without a curve (held eyes, nose and lips; ears and neck without bone; failed ones)
/// take the mean travel of the neighbours that have one, ring by ring, and are then smoothed, so
/// that the force stays continuous; they are marked in `estimated`. A piece of skin that is
/// connected to no curve takes the median curve of the map.
/// @throws InputError  no curve at all, sizes that disagree, a curve that does not ascend, a head
///                     smaller than 1 mm or a vertex farther than 100 m, an option out of range;
///                     names the vertex
/// @note Deterministic. Takes about 1 s per million triangles.
[[nodiscard]] TouchModel make_touch_model(const TouchableHead& head,
                                          const TouchModelOptions& options = {});

/// [N/mm] per region: median over its computed vertices of 2 N / u(2 N); NaN for a region without.
/// Indexed by SkinRegion.
[[nodiscard]] std::array<double, kSkinRegionNames.size()> region_stiffness(const TouchModel& model);

}  // namespace palpate::haptics
