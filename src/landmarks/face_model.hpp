// SPDX-License-Identifier: GPL-3.0-or-later
// The product's own statistical face: where a head's points lie on average and how they vary
// together. Built from MakeHuman's targets (CC0) by tools/assets/face_model.py; symmetric.
#pragma once
#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/types.hpp"

namespace palpate::landmarks {

/// Head frame, [mm], origin midway between the outer eye corners, adult mean size. A shape is
/// mean + sum_k c_k mode_k with c_k of unit standard deviation in the population. The right half is
/// the mirror image of the left, so every shape is symmetric. The last mode is no shape but a pose:
/// the way to an open mouth, 0 closed, 1 a chin turned down by 19 degrees.
struct FaceModel {
  static constexpr int kShapes = 16;        ///< hold 94 % of the variance of 500 random heads
  static constexpr int kOpening = kShapes;  ///< the mode that opens the mouth
  static constexpr int kModes = kShapes + 1;
  static constexpr double kOpeningAngle = 0.337;  ///< [rad] of the jaw, for a kOpening of 1
  using Modes = std::array<Vec3, kModes>;
  using Coefficients = std::array<double, kModes>;

  std::vector<Vec3> points;   ///< [mm] sample of face, brow and vault; about 7 and 16 mm apart
  std::vector<Vec3> normals;  ///< [-] outward, of the mean
  std::vector<Modes> modes;   ///< [mm per SD] one per point
  std::map<std::string, Vec3> marks;        ///< [mm] named points of the mean
  std::map<std::string, Modes> mark_modes;  ///< [mm per SD]

  [[nodiscard]] Vec3 point(std::size_t i, const Coefficients& c) const;
  /// @param name  a key of `marks`
  [[nodiscard]] Vec3 mark(const std::string& name, const Coefficients& c) const;
};

/// The one model; built at first use, constant afterwards, safe from any thread.
[[nodiscard]] const FaceModel& face_model();

}  // namespace palpate::landmarks
