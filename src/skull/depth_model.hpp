// SPDX-License-Identifier: GPL-3.0-or-later
// How deep under the skin each point of the template is expected to lie, and how sure that is.
#pragma once
#include <string>
#include <vector>

#include "core/skull.hpp"

namespace palpate::skull {

struct DepthModelOptions {
  double range = 30;    ///< [mm] over which depths of neighbouring landmarks resemble each other
  double spread = 5;    ///< [mm] how much the mean depth varies from place to place
  double nugget = 0.5;  ///< [mm] rounding of the table
};

struct LandmarkTarget {
  std::string code;              ///< with side
  Vec3 position = Vec3::Zero();  ///< [mm] template
  double mean = 0, sd = 0;       ///< [mm]; sd > 0
};

/// One entry per point of the template's mesh.
struct DepthModel {
  std::vector<double> mean;  ///< [mm]
  std::vector<double> sd;    ///< [mm] individuals' spread and the interpolation's doubt together
  std::vector<double> area;  ///< [mm^2] of outward-looking bone; 0 where other bone lies in front
  std::vector<LandmarkTarget> landmarks;
};

/// Row of the table for a landmark's code with or without side; null where the table has none.
[[nodiscard]] const TissueDepth* find_depth(const std::vector<TissueDepth>& table,
                                            const std::string& code);

/// [-] SD between individuals over mean depth: the median of the table's rows that have both; 0.3
/// where none has. Where flesh is thin people differ by little, where it is thick by much.
[[nodiscard]] double typical_variation(const std::vector<TissueDepth>& table);

/// Interpolates the table over the template by kriging with a drift (docs/method/fit.md).
/// @throws InputError  the template carries no landmark of the table
[[nodiscard]] DepthModel make_depth_model(const SkullTemplate& skull,
                                          const std::vector<TissueDepth>& table,
                                          const DepthModelOptions& options = {});

/// Distance [mm] from each point to the mesh's convex hull: how deep the hollow is that muscle
/// fills.
[[nodiscard]] std::vector<double> hull_gaps(const SurfaceMesh& mesh);

}  // namespace palpate::skull
