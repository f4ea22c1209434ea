// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a head in closed form for the tests of the page:  write_test_head OUT.glb CUTS [face]
// 8 CUTS^2 triangles; below -90 mm no vertex has a curve. "face": completed behind z = -20 mm.
// write_test_head OUT.glb SCAN.ply  makes one of the bundled scan (real_head.hpp).
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string_view>

#include "haptics/scenes.hpp"
#include "io/head_file.hpp"
#include "real_head.hpp"

int main(int argc, char** argv) {
  using namespace palpate;
  if (argc == 3 && std::string_view(argv[2]).ends_with(".ply")) {
    io::write_head(argv[1], serve::real_head(argv[2]));
    return 0;
  }
  if (argc != 3 && !(argc == 4 && std::string_view(argv[3]) == "face")) return 2;
  TouchableHead head = haptics::scenes::bumpy_head(std::atoi(argv[2]));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::size_t forces = head.map.forces.size();
  for (std::size_t v = 0; v < head.skin.points.size(); ++v) {
    head.map.depth[v] = 4 + 10 * (1 + head.skin.points[v].y() / 111);
    head.map.error[v] = 0.02;
    if (head.skin.points[v].y() > -90) continue;
    head.map.status[v] = VertexStatus::no_bone;
    head.map.error[v] = head.map.depth[v] = kNone;
    for (std::size_t i = 0; i < forces; ++i) head.map.displacement[v * forces + i] = kNone;
  }
  // Dents from sharp at the one ear to wide at the other.
  head.map.dents = {2, {0, 4, 10, 30}, {}};
  for (std::size_t v = 0; v < head.skin.points.size(); ++v) {
    const double wide = 0.5 + 0.4 * head.skin.points[v].x() / 111;
    for (const double share : {1.0, 0.7 * wide, 0.2 * wide * wide - 0.05, 0.0})
      head.map.dents.share.push_back(head.map.has_curve(v) ? share : kNone);
  }
  head.skull.points = head.skin.points;
  for (Vec3& p : head.skull.points) p *= 0.9;
  head.skull.triangles = head.skin.triangles;
  head.skull_region.assign(head.skull.points.size(), SkullRegion::none);
  if (argc == 4)
    for (const Vec3& p : head.skin.points) head.completed.push_back(p.z() < -20 ? 1 : 0);
  io::write_head(argv[1], head);
}
