// SPDX-License-Identifier: GPL-3.0-or-later
// The figures that people compare: per region, and the order of the regions.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/touchable_head.hpp"

namespace palpate::report {

/// Force at which regions are compared (docs/method/regions.md), [N].
inline constexpr double kComparedForce = 2.0;

struct RegionFigures {
  SkinRegion region = SkinRegion::other;
  std::size_t vertices = 0;
  std::size_t with_curve = 0;
  double stiffness = 0;          ///< [N/mm] median of 2 N / u(2 N); NaN where no curve
  double depth = 0;              ///< [mm] median tissue depth; NaN where none
  std::vector<double> median_u;  ///< [mm] median travel at each force of the map
};
struct RegionSummary {
  std::vector<RegionFigures> regions;  ///< all regions that have vertices, in the enum's order
  std::vector<SkinRegion> order;       ///< of the seven present, stiff to soft
  std::optional<double> kendall_tau;   ///< against the published order; none below two regions
};

[[nodiscard]] RegionSummary region_summary(const TouchableHead& head);
[[nodiscard]] nlohmann::json to_json(const RegionSummary& summary);
/// Kendall's tau-b [-] of two equally long samples; ties allowed. NaN where one sample is constant.
[[nodiscard]] double kendall_tau(std::span<const double> a, std::span<const double> b);

}  // namespace palpate::report
