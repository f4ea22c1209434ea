// SPDX-License-Identifier: Apache-2.0
// How the device's small workspace lies in the head's frame.
#pragma once
#include "haptics/device.hpp"
#include "haptics/touch_model.hpp"

namespace palpate::haptics {

/// head = at_head + scale * rotation * (user - at_user). Forces and velocities turn with it; forces
/// are not scaled.
struct Workspace {
  Mat3 rotation = Mat3::Identity();  ///< user's axes -> head's axes, proper
  Vec3 at_user = Vec3::Zero();       ///< [mm]
  Vec3 at_head = Vec3::Zero();       ///< [mm]
  double scale = 1;                  ///< [-] > 0

  [[nodiscard]] Vec3 to_head(const Vec3& user) const {
    return at_head + scale * (rotation * (user - at_user));
  }
  [[nodiscard]] Vec3 velocity_to_head(const Vec3& user) const { return scale * (rotation * user); }
  [[nodiscard]] Vec3 force_to_user(const Vec3& head) const { return rotation.transpose() * head; }
};

/// The user sits before the face: the middle of the device's workspace lies `gap` mm in front of
/// the nose, axes alike.
[[nodiscard]] Workspace facing(const TouchModel& model, const DeviceInfo& device, double gap = 20,
                               double scale = 1);
/// The head is turned so that `point` of the skin lies at the middle of the workspace with its
/// normal towards the user, and the head's up as near to the user's up as that allows.
[[nodiscard]] Workspace aimed_at(const Vec3& point, const Vec3& normal, const DeviceInfo& device,
                                 double scale = 1);
/// aimed_at() the middle of a region: its vertex in the direction of the mean of its vertices, seen
/// from the middle of the head; of those on the subject's left for regions in pairs.
/// @throws InputError  the head has no vertex of that region
[[nodiscard]] Workspace aimed_at(const TouchModel& model, SkinRegion region,
                                 const DeviceInfo& device, double scale = 1);

}  // namespace palpate::haptics
