// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of the skin are solved in full.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate::stiffness {

/// Farthest-point sampling of the rows of `inputs`: the first is drawn with `seed`, each next one
/// is the row farthest from all chosen (lowest index on ties). Returns min(count, rows) row numbers
/// in the order of choice, so that fewer sites are a prefix of more.
/// @note O(count * rows * columns); deterministic.
[[nodiscard]] std::vector<std::int32_t> farthest_points(const Eigen::MatrixXd& inputs, int count,
                                                        std::uint64_t seed);

}  // namespace palpate::stiffness
