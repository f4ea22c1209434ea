// SPDX-License-Identifier: GPL-3.0-or-later
// Real heads, where the development data is at hand.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "closed.hpp"
#include "surface/repair.hpp"

namespace palpate::surface {
namespace {

namespace fs = std::filesystem;

fs::path heads_folder() {
  const char* shared = std::getenv("PALPATE_SHARED");
  return (shared ? fs::path(shared) : fs::path(PALPATE_SOURCE_DIR) / ".." / "shared") / "heads";
}

// Binary little-endian PLY of float points and triangles, as all heads of the folder are.
SurfaceMesh read_head(const fs::path& file, double unit_mm) {
  std::ifstream in(file, std::ios::binary);
  std::size_t points = 0, triangles = 0;
  for (std::string line; std::getline(in, line) && line != "end_header";) {
    if (line.starts_with("element vertex ")) points = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) triangles = std::stoul(line.substr(13));
  }
  SurfaceMesh m;
  std::array<float, 3> p;
  for (std::size_t i = 0; i < points; ++i) {
    in.read(reinterpret_cast<char*>(p.data()), sizeof p);
    m.points.push_back(unit_mm * Vec3(p[0], p[1], p[2]));
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    Triangle t;
    in.ignore(1);
    in.read(reinterpret_cast<char*>(t.data()), sizeof t);
    m.triangles.push_back(t);
  }
  return m;
}

struct Head {
  const char* name;
  double unit_mm;
  std::size_t holes, pockets;  // the neck and ICT's eyes; sockets, mouth, nostrils, ear canals
};
class Heads : public testing::TestWithParam<Head> {};

TEST_P(Heads, GoThrough) {
  const fs::path file = heads_folder() / (std::string(GetParam().name) + ".ply");
  if (!fs::exists(file)) GTEST_SKIP() << "no development data at " << file.parent_path();
  const WorkingSurface w = make_working_surface(read_head(file, GetParam().unit_mm));
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.holes_filled, GetParam().holes);
  EXPECT_EQ(w.report.pockets_closed, GetParam().pockets);
  EXPECT_FALSE(w.report.wrapped);
  EXPECT_LT(w.report.deviation_p95_mm, 0.45);  // coarse heads have edges of 8 mm and hard corners
}

INSTANTIATE_TEST_SUITE_P(All, Heads,
                         testing::Values(Head{"mh_base", 1, 1, 3}, Head{"mh_a", 1, 1, 3},
                                         Head{"mh_b", 1, 1, 3}, Head{"ict_00", 10, 4, 3},
                                         Head{"ict_21", 10, 4, 3}, Head{"ict_22", 10, 4, 3},
                                         Head{"ct_skin", 1, 0, 4}),
                         [](const auto& head) { return std::string(head.param.name); });

}  // namespace
}  // namespace palpate::surface
