// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of the skin are solved in full.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "stiffness/ground.hpp"

namespace palpate::stiffness {

/// Farthest-point sampling of the rows of `inputs`: the first is drawn with `seed`, each next one
/// is the row farthest from all chosen (lowest index on ties). Returns min(count, rows) row numbers
/// in the order of choice, so that fewer sites are a prefix of more.
/// @note O(count * rows * columns); deterministic.
[[nodiscard]] std::vector<std::int32_t> farthest_points(const Eigen::MatrixXd& inputs, int count,
                                                        std::uint64_t seed);

/// `count` of the spots with tissue, spread over what the tool sees and over the head; all of them,
/// in order, where there are no more.
[[nodiscard]] std::vector<std::int32_t> choose_sites(const Ground& ground,
                                                     const std::vector<std::int32_t>& tissue,
                                                     int count);

}  // namespace palpate::stiffness
