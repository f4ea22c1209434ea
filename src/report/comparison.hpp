// SPDX-License-Identifier: GPL-3.0-or-later
// Two touchable heads of the same scan, vertex by vertex: one whose skull was estimated, one whose
// skull is known.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/progress.hpp"
#include "core/touchable_head.hpp"

namespace palpate::report {

struct ComparisonOptions {
  std::vector<Box> leave_out;  ///< scan frame, [mm]: places that say nothing (a defect, a cut)
  double reach = 4;            ///< [mm] to the other scan's nearest vertex; > 0
  double deepest = 40;         ///< [mm] deeper bone on either side is not compared
};

struct RegionComparison {
  SkinRegion region = SkinRegion::other;
  std::size_t vertices = 0;    ///< whose depths were compared
  double depth_error = 0;      ///< [mm] mean size of the difference
  double depth_bias = 0;       ///< [mm] median of estimated minus true
  double stiffness_error = 0;  ///< [-] median size of k / k_true - 1
  double within_two_sd = 0;    ///< [-] share; NaN where the estimated head states no spread
  double stated_sd = 0;        ///< [mm] mean; likewise
};

/// NaN stands for "none could be compared".
struct Comparison {
  std::vector<double> depth;      ///< [mm] per vertex, estimated minus true
  std::vector<double> stiffness;  ///< [-] per vertex, k / k_true - 1 at kComparedForce
  RegionComparison all;
  double depth_p95 = 0;                   ///< [mm]
  std::vector<RegionComparison> regions;  ///< those with vertices, in the enum's order
  /// Over the six facial regions (all of the seven but the cranium): the mean error, and that of
  /// the one depth that suits the true head best (its median).
  double face_error = 0, face_constant_error = 0;
};

/// Vertices are paired by number where both heads have the same vertices, else with the nearest.
/// @throws InputError  the heads do not lie on each other: not the same scan
[[nodiscard]] Comparison compare_heads(const TouchableHead& estimated, const TouchableHead& known,
                                       const ComparisonOptions& options = {});
[[nodiscard]] nlohmann::json to_json(const Comparison& comparison);

/// One page: figures by region, maps of both differences.
/// @throws FileError  cannot write; nothing is left under the name
void write_comparison(const std::filesystem::path& path, const TouchableHead& estimated,
                      const Comparison& comparison, const Progress& progress = {});

}  // namespace palpate::report
