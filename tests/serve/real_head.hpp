// SPDX-License-Identifier: GPL-3.0-or-later
// The bundled scan as a touchable head without a sweep: curves in closed form, so that tests get
// one in no time. Turned, shifted and in metres, so that a mistaken frame or unit shows.
#pragma once
#include "haptics/scenes.hpp"
#include "io/scan.hpp"

namespace palpate::serve {

inline TouchableHead real_head(const std::filesystem::path& scan) {
  TouchableHead head;
  const SurfaceMesh upright = io::read_scan(scan).mesh;  // mm, +y up, +z out of the face
  head.unit_mm = 1000;
  head.frame.rotation =
      (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-0.4, Vec3(1, 2, 3).normalized()))
          .toRotationMatrix();
  head.frame.origin = Vec3(30, -1200, 55);
  const Vec3 eyes(0, 15.571, 73.582);  // midway between the outer corners (data/head.json)
  SurfaceMesh in_head = upright;
  for (Vec3& p : in_head.points) p -= eyes;
  head.map = haptics::scenes::stiffening_map(in_head, 8, [](const Vec3&) { return 2.0; });
  head.skin = in_head;
  for (Vec3& p : head.skin.points)
    p = (head.frame.to_scan(p) / head.unit_mm).cast<float>().cast<double>();  // as it is stored
  const std::map<std::string, Vec3> marks = {{"nose_tip", {0, -20.974, 105.732}},
                                             {"nose_corner_left", {16.966, -21.61, 89.026}},
                                             {"nose_corner_right", {-16.966, -21.61, 89.026}},
                                             {"eye_outer_left", {43.419, 15.571, 73.582}},
                                             {"eye_outer_right", {-43.419, 15.571, 73.582}},
                                             {"eye_inner_left", {17.684, 15.388, 76.118}},
                                             {"eye_inner_right", {-17.684, 15.388, 76.118}}};
  for (const auto& [name, p] : marks) head.landmarks[name] = {head.frame.to_scan(p - eyes), 0.8};
  head.skull = in_head;
  for (Vec3& p : head.skull.points) p = head.frame.to_scan(0.9 * p);
  head.skull_region.assign(head.skull.points.size(), SkullRegion::none);
  head.provenance["options"]["edge_mm"] =
      4;  // not the default: the command that makes it again must say so
  return head;
}

}  // namespace palpate::serve
