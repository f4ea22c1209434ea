// SPDX-License-Identifier: GPL-3.0-or-later
// Small statistics of a stiffness map.
#pragma once
#include <vector>

#include "core/stiffness_map.hpp"

namespace palpate::report {

/// Linear between order statistics (Hyndman & Fan's type 7); values that are not finite are left
/// out; NaN where none is left.
[[nodiscard]] double quantile(std::vector<double> values, double q);
[[nodiscard]] double median(std::vector<double> values);

/// Travel [mm] at a force [N], linear between the samples and from (0, 0) to the first; NaN where
/// the vertex has no curve or the force is beyond the last sample.
[[nodiscard]] double travel_at(const StiffnessMap& map, std::size_t vertex, double force);
/// Whether the vertex' curve stands on an eye's globe or on nasal cartilage, not on bone.
[[nodiscard]] bool stands_on_organ(const StiffnessMap& map, std::size_t vertex);
/// map.error without these vertices (NaN there): their error is an assumption about the organ.
[[nodiscard]] std::vector<double> errors_on_bone(const StiffnessMap& map);
/// kComparedForce / travel there [N/mm]; NaN where there is none.
[[nodiscard]] double compared_stiffness(const StiffnessMap& map, std::size_t vertex);

}  // namespace palpate::report
