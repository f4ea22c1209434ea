// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/error.hpp"
#include "io/assets.hpp"
#include "io/scan.hpp"
#include "samples.hpp"

namespace palpate::io {
namespace {
using namespace test;

TEST(GuessUnit, TellsHeadsAndBustsInEveryUnit) {
  const SurfaceMesh head = ellipsoid(2);  // 240 mm
  const auto in = [&](double mm) {
    return guess_unit(transformed(head, Mat3::Identity() / mm, Vec3::Zero()));
  };
  EXPECT_EQ(in(1).unit, LengthUnit::mm);
  EXPECT_EQ(in(10).unit, LengthUnit::cm);
  EXPECT_EQ(in(100).unit, LengthUnit::dm);
  EXPECT_EQ(in(1000).unit, LengthUnit::m);
  EXPECT_EQ(in(25.4).unit, LengthUnit::inch);
  EXPECT_TRUE(in(1).certain);
  EXPECT_EQ(in(10 / 2.2).unit, LengthUnit::cm);     // 528 mm: shoulders; 1341 mm would be in inches
  EXPECT_EQ(in(10 / 0.6).other, LengthUnit::inch);  // 144 mm in cm, 366 mm in inches
  EXPECT_THROW((void)in(1e-3), InputError);
  EXPECT_THROW((void)in(1e6), InputError);
}

TEST(GuessUnit, StrayPointsDoNotCount) {
  SurfaceMesh head = ellipsoid(4);
  head.points[0] *= 50;                // one bad vertex among a thousand
  head.points.push_back({9e6, 0, 0});  // and one that no face uses
  EXPECT_EQ(guess_unit(head).unit, LengthUnit::mm);
}

const char* const kTemplate = R"({"name": "test", "unit": "mm",
  "landmarks": {"g": {"name": "glabella", "position": [0, 1, 2], "normal": [0, 0, 1]}},
  "registration_points": {"nose_tip": [0, 0, 100]}})";

TEST(Assets, ReadsATemplateWithItsRegions) {
  const TemporaryFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty uchar region\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 1\n1 0 0 2\n0 1 0 {}\n3 0 1 2\n";
  const auto with = [&](const std::string& region, const std::string& notes) {
    std::string text = ply;
    text.replace(text.find("{}"), 2, region);
    folder.write("s.json", notes);
    return read_skull_template(folder.write("s.ply", text));
  };
  const SkullTemplate skull = with("7", kTemplate);
  EXPECT_EQ(skull.name, "test");
  EXPECT_EQ(skull.region,
            (std::vector{SkullRegion::cranium, SkullRegion::forehead, SkullRegion::chin}));
  EXPECT_EQ(skull.landmarks.at("g").position, Vec3(0, 1, 2));
  EXPECT_EQ(skull.registration_points.at("nose_tip"), Vec3(0, 0, 100));
  EXPECT_THROW((void)with("8", kTemplate), InputError);
  EXPECT_THROW((void)with("7", "{}"), InputError);
  EXPECT_THROW((void)with("7", "{\"name\": \"a\", \"landmarks\": {\"g\": {\"position\": [1]}}}"),
               InputError);
  EXPECT_THROW((void)with("7", "not json"), InputError);
}

TEST(Assets, ReadsTheBundledDepthTable) {
  const auto depths = read_tissue_depths(data_folder() / "tissue_depth.csv");
  const auto find = [&](const char* code) {
    return *std::find_if(depths.begin(), depths.end(),
                         [&](const auto& d) { return d.code == code; });
  };
  EXPECT_GE(depths.size(), 25u);
  EXPECT_EQ(find("g").mean_mm, 5.5);
  EXPECT_EQ(find("g").sd_mm, 1);
  EXPECT_EQ(find("lo").sd_mm, 0);
  EXPECT_EQ(find("mm").landmark, "mid-masseter, occlusal line");
}

TEST(Assets, RefusesDamagedTablesByLine) {
  const TemporaryFolder folder;
  const std::string header = "code,landmark,mean_mm,sd_mm,population,source\n";
  const std::string row = "g,glabella,5,1,adults,\"a, b\"\n";
  const auto read = [&](const std::string& text) {
    return read_tissue_depths(folder.write("t.csv", text));
  };
  EXPECT_EQ(read(header + row)[0].source, "a, b");
  for (const std::string& text :
       {std::string("code\n"), header + "g,glabella,5\n", header + row + row,
        header + "g,glabella,-5,1,a,b\n", header + "g,glabella,nan,1,a,b\n",
        header + "g,glabella,5,1,a,\"b\n"})
    EXPECT_THROW((void)read(text), InputError) << text;
}

TEST(Assets, DataFolderFollowsTheEnvironment) {
  const TemporaryFolder folder;
  ::setenv("PALPATE_DATA", folder.path.c_str(), 1);
  EXPECT_EQ(data_folder(), folder.path);
  ::setenv("PALPATE_DATA", "/no/such/folder", 1);
  EXPECT_THROW((void)data_folder(), InputError);
  ::unsetenv("PALPATE_DATA");
}

}  // namespace
}  // namespace palpate::io
