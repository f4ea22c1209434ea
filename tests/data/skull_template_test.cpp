// SPDX-License-Identifier: Apache-2.0
// The skull template: a clean surface, annotated on the bone, of an adult's size.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "core/surface_mesh.hpp"
#include "io/assets.hpp"
#include "mesh_checks.hpp"

namespace palpate {
namespace {

using data_test::distance_to;

constexpr std::uintmax_t kLargestFile = 2'000'000;  // [bytes]

const SkullTemplate& skull() {
  static const SkullTemplate read =
      io::read_skull_template(io::data_folder() / "skull_template.ply");
  return read;
}

Vec3 at(const std::string& code) {
  return skull().landmarks.at(code).position;
}

/// Codes of the depth table with their sides, as the template must have them.
std::set<std::string> expected_codes() {
  std::set<std::string> codes;
  const std::set<std::string> midline = {"op", "v",  "g",  "n",  "mn", "rhi", "ss", "mp",
                                         "pr", "id", "sm", "pg", "gn", "me",  "sg"};
  for (const TissueDepth& row : io::read_tissue_depths(io::data_folder() / "tissue_depth.csv")) {
    if (midline.contains(row.code)) {
      codes.insert(row.code);
    } else {
      codes.insert(row.code + "_left");
      codes.insert(row.code + "_right");
    }
  }
  for (const char* code : {"po_left", "po_right", "or_left", "or_right"}) codes.insert(code);
  return codes;
}

TEST(SkullTemplateTest, IsOneClosedOrientedSphere) {
  const data_test::Topology t = data_test::topology(skull().mesh);
  EXPECT_EQ(t.unpaired_edges, 0u);
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.unused_points, 0u);
  EXPECT_EQ(t.pinched_points, 0u);
  EXPECT_EQ(t.euler, 2);
  EXPECT_GT(signed_volume(skull().mesh), 2.0e6);  // [mm^3] braincase, face and filled inside
  EXPECT_LT(signed_volume(skull().mesh), 2.6e6);
}

TEST(SkullTemplateTest, HasEvenTrianglesOfTwoToThreeMillimetres) {
  const std::vector<double> edges = data_test::edge_lengths(skull().mesh);
  EXPECT_GT(edges.front(), 0.8);
  EXPECT_LT(edges.back(), 4.0);
  EXPECT_GT(edges[edges.size() / 2], 2.0);
  EXPECT_LT(edges[edges.size() / 2], 3.0);
  EXPECT_GT(data_test::worst_quality(skull().mesh), 0.3);
}

TEST(SkullTemplateTest, IsItsOwnMirrorImage) {
  EXPECT_LT(data_test::mirror_error(skull().mesh, 3.0), 1e-4);
  for (const auto& [code, mark] : skull().landmarks) {
    if (!code.ends_with("_left")) continue;
    const SkullLandmark& twin = skull().landmarks.at(code.substr(0, code.size() - 4) + "right");
    EXPECT_NEAR(mark.position.x(), -twin.position.x(), 1e-9) << code;
    EXPECT_NEAR(mark.position.y(), twin.position.y(), 1e-9) << code;
    EXPECT_NEAR(mark.position.z(), twin.position.z(), 1e-9) << code;
    EXPECT_GT(mark.position.x(), 0) << code << ": +x is the subject's left";
  }
}

TEST(SkullTemplateTest, HasEveryLandmarkOfTheDepthTable) {
  std::set<std::string> found;
  for (const auto& [code, mark] : skull().landmarks) found.insert(code);
  EXPECT_EQ(found, expected_codes());
}

TEST(SkullTemplateTest, LandmarksLieOnTheBoneAndNormalsPointOut) {
  for (const auto& [code, mark] : skull().landmarks) {
    EXPECT_LT(distance_to(skull().mesh, mark.position), 0.01) << code;
    EXPECT_NEAR(mark.normal.norm(), 1.0, 1e-3) << code;
    EXPECT_FALSE(data_test::inside(skull().mesh, mark.position + 2.0 * mark.normal)) << code;
    EXPECT_TRUE(data_test::inside(skull().mesh, mark.position - 2.0 * mark.normal)) << code;
  }
}

TEST(SkullTemplateTest, FrankfurtPlaneIsHorizontalThroughTheOrigin) {
  for (const char* code : {"po_left", "po_right", "or_left", "or_right"})
    EXPECT_NEAR(at(code).y(), 0, 0.01) << code;
  EXPECT_NEAR(at("po_left").z(), 0, 0.01);
  EXPECT_GT(at("or_left").z(), 60);
}

TEST(SkullTemplateTest, HasAnAdultsDimensions) {
  // Ranges: mean +- 2.5 SD or so of pooled adult craniometry [mm].
  const Box box = bounding_box(skull().mesh.points);
  EXPECT_NEAR((at("g") - at("op")).norm(), 180, 10) << "greatest length";
  EXPECT_NEAR(box.size().x(), 143, 9) << "greatest breadth";
  EXPECT_NEAR(2 * at("zy_left").x(), 130, 9) << "bizygomatic breadth";
  EXPECT_NEAR((at("n") - at("me")).norm(), 118, 10) << "facial height";
  EXPECT_NEAR((at("n") - at("pr")).norm(), 70, 7) << "upper facial height";
  EXPECT_NEAR(2 * at("go_left").x(), 100, 10) << "bigonial breadth";
  EXPECT_NEAR(at("v").y(), 115, 8) << "auricular height";
}

TEST(SkullTemplateTest, MidlineRunsFromForeheadToChin) {
  double above = at("v").y();
  for (const char* code : {"sg", "g", "n", "mn", "rhi", "ss", "mp", "pr", "id", "sm", "pg", "gn"}) {
    EXPECT_NEAR(at(code).x(), 0, 1e-6) << code;
    EXPECT_LT(at(code).y(), above) << code;
    above = at(code).y();
  }
  EXPECT_LT(at("me").y(), at("gn").y() + 0.01);
}

TEST(SkullTemplateTest, RegistrationPointsLieInSoftTissue) {
  const auto& points = skull().registration_points;
  ASSERT_EQ(points.size(), 5u);
  for (const auto& [name, p] : points) {
    EXPECT_FALSE(data_test::inside(skull().mesh, p)) << name;
    EXPECT_GT(distance_to(skull().mesh, p), 3) << name;
    EXPECT_LT(distance_to(skull().mesh, p), 30) << name;
  }
  EXPECT_GT(points.at("eye_outer_left").x(), points.at("nose_corner_left").x());
  EXPECT_GT(points.at("nose_tip").z(), points.at("nose_corner_left").z());
  EXPECT_EQ(points.at("eye_outer_left").x(), -points.at("eye_outer_right").x());
}

TEST(SkullTemplateTest, HasAllRegionsOnBothSides) {
  ASSERT_EQ(skull().region.size(), skull().mesh.points.size());
  std::array<long, kSkullRegionNames.size()> left{}, right{};
  for (std::size_t i = 0; i < skull().region.size(); ++i) {
    const auto code = static_cast<std::size_t>(skull().region[i]);
    ASSERT_LT(code, kSkullRegionNames.size());
    const double x = skull().mesh.points[i].x();
    if (x > 0) ++left[code];
    if (x < 0) ++right[code];
  }
  for (std::size_t code = 0; code < left.size(); ++code) {
    EXPECT_GT(left[code], 100) << kSkullRegionNames[code];
    EXPECT_EQ(left[code], right[code]) << kSkullRegionNames[code];
  }
}

TEST(SkullTemplateTest, FilesAreSmall) {
  for (const char* file : {"skull_template.ply", "skull_template.json"})
    EXPECT_LE(std::filesystem::file_size(io::data_folder() / file), kLargestFile) << file;
}

}  // namespace
}  // namespace palpate
