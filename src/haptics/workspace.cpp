// SPDX-License-Identifier: Apache-2.0
#include "haptics/workspace.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"

namespace palpate::haptics {

std::string_view name(DeviceStatus status) {
  switch (status) {
    case DeviceStatus::ok:
      return "ok";
    case DeviceStatus::waiting:
      return "waiting";
    case DeviceStatus::lost:
      return "lost";
    case DeviceStatus::stopped:
      return "stopped";
    case DeviceStatus::ignored:
      return "ignored";
  }
  return "lost";
}

Workspace facing(const TouchModel& model, const DeviceInfo& device, double gap, double scale) {
  Workspace w;
  w.at_user = device.center;
  w.scale = scale;
  Vec3 front = model.mesh.points.front();
  for (const Vec3& p : model.mesh.points)
    if (p.z() > front.z()) front = p;
  w.at_head = front + (gap + model.tool_radius) * Vec3::UnitZ();
  return w;
}

Workspace aimed_at(const Vec3& point, const Vec3& normal, const DeviceInfo& device, double scale) {
  Workspace w;
  w.at_user = device.center;
  w.at_head = point;
  w.scale = scale;
  // Columns are the user's axes in the head: z along the normal, y as near to up as can be.
  // Straight above or below, where up gives no direction, the head's front stands in for it.
  const Vec3 z = normal.normalized();
  const Vec3 up = std::abs(z.y()) < 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 x = up.cross(z).normalized();
  w.rotation << x, z.cross(x), z;
  return w;
}

Workspace aimed_at(const TouchModel& model, SkinRegion region, const DeviceInfo& device,
                   double scale) {
  Vec3 left = Vec3::Zero(), all = Vec3::Zero();
  std::size_t lefts = 0, count = 0;
  for (std::size_t p = 0; p < model.region.size(); ++p) {
    if (model.region[p] != region) continue;
    all += model.mesh.points[p];
    ++count;
    if (model.mesh.points[p].x() <= 0) continue;
    left += model.mesh.points[p];
    ++lefts;
  }
  if (count == 0)
    throw InputError(fmt::format("this head has no region '{}'", palpate::name(region)));
  using enum SkinRegion;
  const bool midline = region == cranium || region == forehead || region == chin ||
                       region == nose || region == lips || region == neck || region == other;
  const bool use_left = !midline && lefts > 0;
  const Vec3 middle =
      use_left ? Vec3(left / static_cast<double>(lefts)) : Vec3(all / static_cast<double>(count));
  // The vertex of the region seen from the head's middle in the direction of that mean.
  const Vec3 center = model.mesh.tree.box().center();
  const Vec3 towards = (middle - center).normalized();
  std::size_t best = 0;
  double best_cosine = -2;
  for (std::size_t p = 0; p < model.region.size(); ++p) {
    const double cosine = (model.mesh.points[p] - center).normalized().dot(towards);
    if (model.region[p] != region || cosine <= best_cosine) continue;
    best_cosine = cosine;
    best = p;
  }
  return aimed_at(model.mesh.points[best], model.mesh.normals[best], device, scale);
}

}  // namespace palpate::haptics
