// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <limits>
#include <numbers>

#include "core/touchable_head.hpp"

namespace palpate::report::scenes {

/// Latitude-longitude sphere [mm], closed, normals out.
inline SurfaceMesh sphere(double radius, int rings, const Vec3& centre = Vec3::Zero()) {
  SurfaceMesh m;
  const int around = 2 * rings;
  m.points.push_back(centre + Vec3(0, radius, 0));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / around;
      m.points.push_back(centre + radius * Vec3(std::sin(a) * std::sin(b), std::cos(a),
                                                std::sin(a) * std::cos(b)));
    }
  const int last = static_cast<int>(m.points.size());
  m.points.push_back(centre - Vec3(0, radius, 0));
  const auto at = [&](int i, int j) { return 1 + (i - 1) * around + j % around; };
  for (int j = 0; j < around; ++j) {
    m.triangles.push_back({0, at(1, j), at(1, j + 1)});
    m.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

/// A ball in a ball, in centimetres, turned and moved; bands of height are the regions, in the
/// published order from the top, each softer than the one above where `stiff_to_soft`.
inline TouchableHead ball_head(bool stiff_to_soft = true) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  TouchableHead h;
  h.unit_mm = 10;
  h.frame.rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  h.frame.origin = {30, -200, 55};
  const SurfaceMesh ball = sphere(80, 24), bone = sphere(70, 20);
  h.skin = h.skull = ball;
  for (Vec3& p : h.skin.points) p = h.frame.to_scan(p) / h.unit_mm;
  h.skull = bone;
  for (Vec3& p : h.skull.points) p = h.frame.to_scan(p);
  h.map.forces = {0.5, 1, 1.5, 2, 2.5, 3};
  for (std::size_t v = 0; v < ball.points.size(); ++v) {
    const double part = (80 - ball.points[v].y()) / 160;  // 0 on top, 1 below
    const int band = std::min(7, static_cast<int>(8 * part));
    h.map.region.push_back(band < 7 ? kPublishedOrder[band] : SkinRegion::neck);
    const VertexStatus s = band == 7     ? VertexStatus::no_bone
                           : v % 50 == 0 ? VertexStatus::solved
                                         : VertexStatus::blended;
    h.map.status.push_back(s);
    h.map.error.push_back(s == VertexStatus::blended ? 0.04 : kNan);
    h.map.depth.push_back(band == 7 ? kNan : 10 + band);
    const double soft = stiff_to_soft ? 1 + band : 8 - band;
    for (const double f : h.map.forces)
      h.map.displacement.push_back(band == 7 ? kNan : 0.5 * soft * f);
  }
  h.landmarks["nose_tip"] = {h.frame.to_scan({0, 0, 80}), 0.95};
  h.landmarks["eye_outer_left"] = {h.frame.to_scan({40, 30, 62}), 0.3};
  h.depths = {{"g", 5.5, 1, 6, true},
              {"zy_left", 7.5, 3, 13, true},
              {"fe_left", 4, 0, 5, true},
              {"op", 6, 2, kNan, false}};
  h.provenance = {{"palpate", "0.1.0"},
                  {"input", {{"file", "a<b>&\"c\".ply"}, {"sha256", "0123"}}},
                  {"options", {{"sites", 600}}},
                  {"repair", {{"holes_filled", 2}, {"lines", {"2 holes were closed <here>"}}}},
                  {"fit", {{"surface_error_mean_mm", 2.5}}},
                  {"sweep", {{"sites", 600}}},
                  {"tissue_mesh", {{"nodes", 1000}, {"dihedral_share_060_070", 0.2}}},
                  {"warnings", {"watch <out>"}}};
  h.run = {{"seconds", {{"sweep", 12.5}}}, {"threads", 2}};
  return h;
}

}  // namespace palpate::report::scenes
