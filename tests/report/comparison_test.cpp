// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/comparison.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "scenes.hpp"

namespace palpate::report {
namespace {

TEST(Comparison, OfAHeadWithItselfIsZero) {
  const TouchableHead head = scenes::ball_head();
  const Comparison c = compare_heads(head, head);
  EXPECT_EQ(c.all.depth_error, 0);
  EXPECT_EQ(c.all.stiffness_error, 0);
  EXPECT_TRUE(std::isnan(c.all.within_two_sd));
  EXPECT_GT(c.face_constant_error, 0.5);  // the ball's bands differ by 1 mm
}

TEST(Comparison, MeasuresDepthStiffnessAndCalibration) {
  const TouchableHead known = scenes::ball_head();
  TouchableHead estimated = known;
  for (std::size_t v = 0; v < known.map.size(); ++v) {
    estimated.map.depth[v] += v % 2 ? 3 : -1;
    for (std::size_t f = 0; f < known.map.forces.size(); ++f)
      estimated.map.displacement[v * known.map.forces.size() + f] /= 1.25;
  }
  estimated.spread.depth.assign(known.map.size(), 1);
  estimated.spread.stiffness.assign(known.map.size(), 0.1);
  const Comparison c = compare_heads(estimated, known);
  EXPECT_NEAR(c.all.depth_error, 2, 0.05);
  EXPECT_NEAR(c.all.stiffness_error, 0.25, 1e-9);
  EXPECT_NEAR(c.all.within_two_sd, 0.5, 0.02);
  EXPECT_EQ(c.all.stated_sd, 1);
  for (const RegionComparison& r : c.regions)
    if (r.vertices > 100) EXPECT_NEAR(r.depth_error, 2, 0.1) << name(r.region);
  const auto json = to_json(c);
  EXPECT_NEAR(json["depth"]["within_2_sd"].get<double>(), c.all.within_two_sd, 1e-12);
}

TEST(Comparison, PairsAnotherMeshOfTheSameScanAndLeavesBoxesOut) {
  const TouchableHead known = scenes::ball_head();
  TouchableHead estimated = known;
  const Vec3 shift = Vec3::Constant(0.5 / known.unit_mm);
  for (Vec3& p : estimated.skin.points) p += shift;
  EXPECT_EQ(compare_heads(estimated, known).all.depth_error, 0);
  ComparisonOptions everything;
  everything.leave_out = {{Vec3::Constant(-1e4), Vec3::Constant(1e4)}};
  EXPECT_EQ(compare_heads(estimated, known, everything).all.vertices, 0u);
  for (Vec3& p : estimated.skin.points) p += 1000 * shift;
  EXPECT_THROW((void)compare_heads(estimated, known), InputError);
}

TEST(Comparison, PageIsWritten) {
  const TouchableHead head = scenes::ball_head();
  const auto path = std::filesystem::temp_directory_path() / "palpate_comparison_test.html";
  write_comparison(path, head, compare_heads(head, head));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::filesystem::remove(path);
  EXPECT_NE(text.str().find("cheekbone"), std::string::npos);
  EXPECT_EQ(text.str().find("<script"), std::string::npos);
}

}  // namespace
}  // namespace palpate::report
