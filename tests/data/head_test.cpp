// SPDX-License-Identifier: Apache-2.0
// The bundled head: watertight, of an adult's size, its landmarks on the skin.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "io/assets.hpp"
#include "io/scan.hpp"
#include "mesh_checks.hpp"

namespace palpate {
namespace {

const SurfaceMesh& head() {
  static const SurfaceMesh read = io::read_scan(io::data_folder() / "head.ply").mesh;
  return read;
}

std::map<std::string, Vec3> landmarks() {
  std::ifstream in(io::data_folder() / "head.json");
  const nlohmann::json doc = nlohmann::json::parse(in);
  EXPECT_EQ(doc.at("unit"), "mm");
  EXPECT_EQ(doc.at("front"), "+z");
  EXPECT_EQ(doc.at("up"), "+y");
  std::map<std::string, Vec3> out;
  for (const auto& [name, p] : doc.at("landmarks").items())
    out[name] = Vec3(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
  return out;
}

TEST(BundledHeadTest, IsOneClosedOrientedSphere) {
  const data_test::Topology t = data_test::topology(head());
  EXPECT_EQ(t.unpaired_edges, 0u);
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.unused_points, 0u);
  EXPECT_EQ(t.pinched_points, 0u);
  EXPECT_EQ(t.euler, 2) << "eyes, mouth and neck are closed";
  EXPECT_GT(signed_volume(head()), 3.0e6);  // [mm^3]
  // The patches that close eyes, lips and neck are triangulated without regard to the mirror plane.
  EXPECT_LT(data_test::mirror_error(head(), 10.0), 6.0);
}

TEST(BundledHeadTest, IsOfAnAdultsSizeInMillimetres) {
  const Box box = bounding_box(head().points);
  EXPECT_NEAR(box.size().x(), 175, 20) << "with the ears";
  EXPECT_NEAR(box.size().z(), 205, 20) << "nose tip to back of the head";
  EXPECT_EQ(io::guess_unit(head()).unit, LengthUnit::mm);
  EXPECT_GE(head().triangles.size(), 15'000u);
  EXPECT_LE(head().triangles.size(), 30'000u);
  EXPECT_LE(std::filesystem::file_size(io::data_folder() / "head.ply"), 2'000'000u);
}

TEST(BundledHeadTest, LandmarksLieOnTheSkin) {
  const std::map<std::string, Vec3> marks = landmarks();
  ASSERT_EQ(marks.size(), 7u);
  for (const auto& [name, p] : marks) EXPECT_LT(data_test::distance_to(head(), p), 0.3) << name;
  const Vec3 tip = marks.at("nose_tip");
  EXPECT_NEAR(tip.x(), 0, 1e-6);
  for (const Vec3& p : head().points) EXPECT_LE(p.z(), tip.z() + 0.5) << "the nose tip is foremost";
  EXPECT_GT(marks.at("eye_outer_left").x(), marks.at("eye_inner_left").x());
  EXPECT_GT(marks.at("eye_inner_left").x(), 0);
  EXPECT_LT(marks.at("eye_outer_right").x(), marks.at("eye_inner_right").x());
}

}  // namespace
}  // namespace palpate
