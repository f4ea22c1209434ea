// SPDX-License-Identifier: Apache-2.0
// make_test_head FILE: a closed-form head with 2048 triangles, in centimetres, off the origin.
#include <cstdio>

#include "haptics/scenes.hpp"
#include "io/head_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  using namespace palpate;
  try {
    TouchableHead head = haptics::scenes::bumpy_head(16);
    head.unit_mm = 10;
    head.frame.origin = Vec3(10, -20, 30);
    for (Vec3& p : head.skin.points) p = (p + head.frame.origin) / head.unit_mm;
    head.map.status[7] = VertexStatus::held;  // a vertex without a curve of its own
    for (std::size_t i = 0; i < head.map.forces.size(); ++i)
      head.map.displacement[7 * head.map.forces.size() + i] = std::nan("");
    head.provenance = head.run = nlohmann::json::object();
    io::write_head(argv[1], head);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
