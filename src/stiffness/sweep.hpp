// SPDX-License-Identifier: GPL-3.0-or-later
// A force-travel curve at every point of the skin.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "core/stiffness_map.hpp"

namespace palpate::stiffness {

struct SweepOptions {
  double tool_radius = 8;            ///< [mm] sphere; > 0
  double youngs_modulus = 0.045658;  ///< [MPa] flesh; > 0
  double poissons_ratio = 0.43;      ///< [-] flesh; 0 <= nu < 0.5
  int loads = 10;                    ///< number of equal force steps up to max_force; >= 1
  double max_force = 5;              ///< [N]
  int sites = 300;                   ///< skin points solved in full; the rest is blended
  double no_bone_beyond = 40;        ///< [mm] no curve where bone is farther along the normal
  std::uint64_t seed = 1;            ///< for the choice of sites
  int threads = 0;                   ///< 0: all cores; the result does not depend on it
};

struct Sweep {
  StiffnessMap map;                          ///< on the points of head.skin
  std::vector<std::int32_t> sites;           ///< points of head.skin that were solved
  std::map<std::string, double> statistics;  ///< named figures, units in the names
  std::vector<std::string> warnings;
};

/// Presses a frictionless rigid sphere along the inward normal at chosen sites and blends the
/// curves to all points of the working skin.
/// @note Same bits for any thread count. A site that does not converge has status failed and no
/// curve.
[[nodiscard]] Sweep sweep(const HeadSurface& head, const SkullFit& skull,
                          const SweepOptions& options = {}, const Progress& progress = {});

/// The map carried to other points of the same skin (the user's vertices) by the closest point's
/// barycentric weights; tissue depth is measured anew along the smoothed inward normal.
/// Status: held in an organ's region, no_bone on an ear or farther than 4 mm from the working skin;
/// otherwise that of the nearest corner, where corners without a curve are left out of the mix.
/// A point keeps `solved` only where it coincides with a solved one.
/// @param points  [mm] head frame
/// @param region  one per point
[[nodiscard]] StiffnessMap transfer(const StiffnessMap& map, const HeadSurface& head,
                                    const SkullFit& skull, const std::vector<Vec3>& points,
                                    const std::vector<Vec3>& normals,
                                    const std::vector<SkinRegion>& region);

}  // namespace palpate::stiffness
