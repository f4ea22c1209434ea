// SPDX-License-Identifier: GPL-3.0-or-later
// From "the bone may lie elsewhere" and "flesh differs between people" to error bars of the map.
#pragma once
#include <cstdint>
#include <vector>

#include "core/head_surface.hpp"
#include "core/map_spread.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "core/stiffness_map.hpp"
#include "stiffness/carriers.hpp"

namespace palpate::stiffness {

struct SpreadOptions {
  /// [-] standard deviation of ln E between people at one place of the face: root mean square of
  /// SD / mean over the five sites of data/tissue/facial_stiffness_in_vivo.csv (28 people); >= 0
  double modulus_spread = 0.39;
  double force = 2;                           ///< [N] of the stiffness that the spread is about
  double cover_sd = OrganOptions{}.cover_sd;  ///< [mm] of the depth of globes and cartilage
  double no_bone_beyond = 40;  ///< [mm] a bone that left its place counts as this far
};

/// How the stiffness F/u of a layer on bone answers at a fixed force.
struct LayerSensitivity {
  double to_depth = 0;    ///< d ln k / d ln depth: 0 over deep tissue, -2 to -3 over thin
  double to_modulus = 1;  ///< d ln k / d ln E: 2/3 over deep tissue
};
/// Rigid frictionless sphere on a linear elastic layer bonded to bone, nu = 0.43.
/// @param travel  [mm] of the sphere, > 0     @param depth  [mm] of the layer, > 0
/// @cite Hayes et al. 1972 (tests/reference/bonded_layer_indentation.csv)
[[nodiscard]] LayerSensitivity layer_sensitivity(double travel, double depth, double tool_radius);

/// d ln k / d ln depth of one head at a fixed force, by finite differences between its own
/// vertices: the slope of ln k over ln depth among vertices of like depth. It holds what the linear
/// layer does not: flesh that stiffens as the tool nears the bone.
class DepthResponse {
 public:
  /// @param depth, stiffness  one per vertex; those not finite or not above zero are left out
  DepthResponse(const std::vector<double>& depth, const std::vector<double>& stiffness);
  /// Slope at a depth [mm], from -2 to 0; `otherwise` where too few vertices are that deep.
  [[nodiscard]] double at(double depth, double otherwise) const;

 private:
  double first_ = 0;           // ln depth of the first node
  std::vector<double> slope_;  // per node; NaN where too few vertices lie around
};

/// Depth: root mean square over the skull's draws of how much deeper or shallower their bone is
/// along the smoothed inward normal. A measured skull (no draws) counts as exact: 0.
/// Stiffness: depth, modulus and the curve's own error, independent of each other, each by first
/// order.
/// @param map     one row per point
/// @param points  [mm] head frame
/// @note Same bits for any thread count.
[[nodiscard]] MapSpread map_spread(const StiffnessMap& map, const HeadSurface& head,
                                   const SkullFit& skull, const std::vector<Vec3>& points,
                                   const SpreadOptions& options = {},
                                   const Progress& progress = {});

/// 1 where the result at a point rests on skin that nobody scanned: where the press moves skin of
/// the completed head (HeadSurface::filled == 2) by 2 % of the tool's travel and more (the dent);
/// without a curve or dents, where the tool would touch it. Empty where nothing was completed.
/// @param map     one row per point
/// @param points  [mm] head frame
[[nodiscard]] std::vector<std::uint8_t> rests_on_completed(const StiffnessMap& map,
                                                           const HeadSurface& head,
                                                           const std::vector<Vec3>& points);

}  // namespace palpate::stiffness
