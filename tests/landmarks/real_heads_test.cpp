// SPDX-License-Identifier: GPL-3.0-or-later
// Heads that are not shipped: PALPATE_SHARED or ../shared beside the sources; skipped without them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "core/error.hpp"
#include "heads.hpp"

namespace palpate::landmarks {
namespace {

std::filesystem::path heads_folder() {
  const char* set = std::getenv("PALPATE_SHARED");
  const std::filesystem::path shared =
      set ? std::filesystem::path(set)
          : std::filesystem::path(PALPATE_SOURCE_DIR).parent_path() / "shared";
  return shared / "heads";
}

TEST(RealHeads, NoseAndEyesAreNearTheirTruth) {
  const auto folder = heads_folder();
  if (!std::filesystem::exists(folder / "heads.json")) {
    GTEST_SKIP() << "no heads under " << folder << "; set PALPATE_SHARED";
  }
  const auto doc = nlohmann::json::parse(std::ifstream(folder / "heads.json"));
  double nose = 0, eyes = 0, worst = 0;
  int noses = 0, corners = 0;
  for (const auto& [name, entry] : doc.items()) {
    if (!entry.contains("landmarks") || name == "humface") continue;
    const double unit = entry.at("unit") == "cm" ? 10 : 1;
    SurfaceMesh scan = io::read_scan(folder / entry.at("file").get<std::string>()).mesh;
    for (Vec3& p : scan.points) p *= unit;
    const auto working = surface::make_working_surface(scan);
    const Detection found = detect_landmarks(working.mesh, with_scan(scan));
    for (const auto& [mark, p] : entry.at("landmarks").items()) {
      const Vec3 truth = unit * Vec3(p[0], p[1], p[2]);
      const double e = (found.landmarks.at(mark).position - truth).norm();
      worst = std::max(worst, e);
      if (mark == "nose_tip") nose += e, ++noses;
      if (mark.starts_with("eye")) eyes += e, ++corners;
    }
  }
  ASSERT_GT(noses, 0);
  std::cout << "nose tip " << nose / noses << " mm, eye corners " << eyes / corners << " mm, worst "
            << worst << " mm\n";
  EXPECT_LE(nose / noses, 3);
  EXPECT_LE(eyes / corners, 5);
  EXPECT_LE(worst, 10);
}

}  // namespace
}  // namespace palpate::landmarks
