// SPDX-License-Identifier: Apache-2.0
// The small types that every stage speaks. Units: mm, N, s, MPa.
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Triangle = std::array<std::int32_t, 3>;     ///< corners, counter-clockwise seen from outside
using Tetrahedron = std::array<std::int32_t, 4>;  ///< det(b-a, c-a, d-a) > 0

}  // namespace palpate
