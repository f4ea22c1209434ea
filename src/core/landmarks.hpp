// SPDX-License-Identifier: Apache-2.0
// Named points of the face and the frame that they define.
#pragma once
#include <map>
#include <string>

#include "core/types.hpp"

namespace palpate {

/// One named point. Left and right are the subject's.
struct Landmark {
  Vec3 position = Vec3::Zero();  ///< [mm], in the frame that the holder states
  double confidence = 0;         ///< [-] 0 (a guess) to 1 (certain); 1 for a user's own point
};

/// Keyed by name: nose_tip, nose_corner_left, nose_corner_right, eye_outer_left, eye_inner_left,
/// eye_inner_right, eye_outer_right; optional: chin, nasion, glabella, mouth_corner_left,
/// mouth_corner_right, ear_left, ear_right (centre of the auricle), gnathion, subnasale, stomion.
using LandmarkSet = std::map<std::string, Landmark>;

/// Head frame: +x to the subject's left, +y up, +z out of the face, origin midway between the outer
/// eye corners. x_head = rotation * (x_scan - origin), both in [mm].
struct HeadFrame {
  Mat3 rotation = Mat3::Identity();  ///< proper rotation; rows are the head's axes in the scan
  Vec3 origin = Vec3::Zero();        ///< [mm] in the scan

  [[nodiscard]] Vec3 to_head(const Vec3& scan) const { return rotation * (scan - origin); }
  [[nodiscard]] Vec3 to_scan(const Vec3& head) const {
    return rotation.transpose() * head + origin;
  }
};

}  // namespace palpate
