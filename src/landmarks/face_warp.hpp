// SPDX-License-Identifier: GPL-3.0-or-later
// From one head's proportions to the mean head's.
#pragma once
#include <vector>

#include "core/landmarks.hpp"

namespace palpate::landmarks {

/// A smooth map of the head frame that takes a head's landmarks near those of the mean face:
/// an affine part for the whole head and Gaussian bumps around the landmarks, smoothed, so that a
/// landmark that is a few millimetres off bends its surroundings only.
class FaceWarp {
 public:
  /// @param landmarks  head frame, [mm]; at least nose_tip and the two outer eye corners
  /// @throws InputError  names the missing one
  explicit FaceWarp(const LandmarkSet& landmarks);
  /// @return [mm] the same place on the mean face
  [[nodiscard]] Vec3 to_mean(const Vec3& head) const;

 private:
  std::vector<Vec3> centers_;  ///< [mm] head frame
  std::vector<Vec3> weights_;  ///< [mm] of the bumps
  Mat3 linear_ = Mat3::Identity();
  Vec3 offset_ = Vec3::Zero();
};

}  // namespace palpate::landmarks
