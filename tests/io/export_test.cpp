// SPDX-License-Identifier: Apache-2.0
// What goes out can be read by the formats' own rules.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/csv.hpp"
#include "io/export.hpp"
#include "io/scan.hpp"
#include "io/vtk_xml.hpp"
#include "samples.hpp"

namespace palpate::io {
namespace {
using namespace test;

TEST(Export, SurfacesComeBackInEveryFormat) {
  const TemporaryFolder folder;
  SurfaceMesh mesh = ellipsoid(2);
  for (const bool single : {true, false}) {
    if (!single) mesh.points[7].x() += 1e-9;  // needs a double
    for (const char* name : {"a.ply", "a.obj", "a.off"}) {
      write_surface(folder.path / name, mesh);
      const Scan scan = read_scan(folder.path / name);
      EXPECT_EQ(scan.mesh.points, mesh.points) << name;
      EXPECT_EQ(scan.mesh.triangles, mesh.triangles) << name;
    }
  }
  write_surface(folder.path / "a.stl", mesh);
  EXPECT_EQ(read_scan(folder.path / "a.stl").mesh.triangles.size(), mesh.triangles.size());
  EXPECT_THROW(write_surface(folder.path / "a.3ds", mesh), InputError);
  EXPECT_THROW(write_surface(folder.path / "no" / "a.ply", mesh), FileError);
  mesh.triangles[3][1] = 9999;
  EXPECT_THROW(write_surface(folder.path / "b.ply", mesh), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "b.ply"));
}

TEST(Export, FloatsAreWrittenAsFloatsWhereNothingIsLost) {
  const TemporaryFolder folder;
  SurfaceMesh mesh = ellipsoid(1);
  write_surface(folder.path / "a.ply", mesh);
  EXPECT_NE(read_file(folder.path / "a.ply").find("property float x"), std::string::npos);
  mesh.points[0].z() = 0.1;
  write_surface(folder.path / "a.ply", mesh);
  EXPECT_NE(read_file(folder.path / "a.ply").find("property double x"), std::string::npos);
}

TEST(Export, CsvHasTheColumnsAndOneRowPerVertexInOrder) {
  const TemporaryFolder folder;
  const TouchableHead head = sample_head();
  write_map_csv(folder.path / "map.csv", head);
  const std::string text = read_file(folder.path / "map.csv");
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "vertex,x,y,z,region,depth_mm,status,error,f_1,f_2,f_3,f_4,f_5,f_6,f_7,f_8,f_9,f_10,"
            "u_1,u_2,u_3,u_4,u_5,u_6,u_7,u_8,u_9,u_10");
  const auto rows = parse_csv({"map.csv", text, {}});
  ASSERT_EQ(rows.size(), head.map.size() + 1);
  for (std::size_t v = 0; v < head.map.size(); ++v) {
    const auto& cell = rows[v + 1].cells;
    ASSERT_EQ(cell.size(), 28u);
    EXPECT_EQ(cell[0], std::to_string(v));
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(std::stof(cell[1 + k]), static_cast<float>(8 * head.skin.points[v][k]));
    EXPECT_EQ(cell[4], name(head.map.region[v]));
    EXPECT_EQ(cell[6], name(head.map.status[v]));
    EXPECT_EQ(cell[7] == "nan", std::isnan(head.map.error[v]));
    EXPECT_EQ(cell[8], "0.5");
    EXPECT_EQ(cell[17], "5");
    for (int i = 0; i < 10; ++i)
      if (head.map.has_curve(v)) {
        EXPECT_EQ(std::stof(cell[18 + i]), static_cast<float>(head.map.curve(v)[i]));
      } else {
        EXPECT_EQ(cell[18 + i], "nan");
      }
  }
  const auto sidecar = nlohmann::json::parse(read_file(folder.path / "map.csv.json"));
  ASSERT_EQ(sidecar["columns"].size(), 28u);
  for (std::size_t c = 0; c < 28; ++c) EXPECT_EQ(sidecar["columns"][c]["name"], rows[0].cells[c]);
}

TEST(Export, MapPlyIsAPlyWithTheMapAsProperties) {
  const TemporaryFolder folder;
  const TouchableHead head = sample_head();
  write_map_ply(folder.path / "map.ply", head);
  const Scan scan = read_scan(folder.path / "map.ply");
  EXPECT_EQ(scan.mesh.points[9], 8 * head.skin.points[9]);
  const std::string bytes = read_file(folder.path / "map.ply");
  const ParsedMesh u = parse_ply({"map.ply", bytes, {}}, "u_4");
  EXPECT_EQ(u.property[7], head.map.curve(7)[3]);
  const ParsedMesh region = parse_ply({"map.ply", bytes, {}}, "region");
  EXPECT_EQ(region.property[8], static_cast<double>(head.map.region[8]));
}

/// The values of an array in a VTK XML file.
std::string vtk_array(const std::string& text, const std::string& name) {
  const std::size_t at = text.find(fmt::format("Name=\"{}\"", name));
  const std::size_t begin = text.find('\n', at) + 1;
  const std::string encoded = text.substr(begin, text.find('\n', begin) - begin);
  std::string bits, out;
  for (const char c : encoded) {
    const std::size_t v =
        std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/")
            .find(c);
    if (v == std::string_view::npos) break;
    for (int k = 5; k >= 0; --k) bits.push_back((v >> k & 1) != 0 ? '1' : '0');
  }
  for (std::size_t i = 0; i + 8 <= bits.size(); i += 8)
    out.push_back(static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2)));
  std::uint64_t length = 0;
  std::memcpy(&length, out.data(), 8);
  EXPECT_EQ(length, out.size() - 8) << name;
  return out.substr(8);
}

TEST(Export, VtkArraysCarryTheirLengthAndValues) {
  const TemporaryFolder folder;
  const TouchableHead head = sample_head();
  write_map_vtp(folder.path / "map.vtp", head);
  const std::string text = read_file(folder.path / "map.vtp");
  const std::string u = vtk_array(text, "u_3");
  ASSERT_EQ(u.size(), 4 * head.map.size());
  float value = 0;
  std::memcpy(&value, u.data() + 4 * 7, 4);
  EXPECT_EQ(value, static_cast<float>(head.map.curve(7)[2]));
  EXPECT_EQ(vtk_array(text, "connectivity").size(), 24 * head.skin.triangles.size());
  EXPECT_EQ(vtk_array(text, "status").size(), head.map.size());
  write_tissue(folder.path / "t.vtu", sample_tissue());
  const std::string tissue = read_file(folder.path / "t.vtu");
  EXPECT_EQ(vtk_array(tissue, "types"), std::string(3, '\x0a'));
  EXPECT_EQ(vtk_array(tissue, "label"), std::string("\1\2\1"));
  EXPECT_EQ(vtk_array(tissue, "points").size(), 6 * 24u);
}

TEST(Export, MapsOfACompletedFaceSayWhatRestsOnCompletedSkin) {
  const TemporaryFolder folder;
  TouchableHead head = sample_head();
  head.completed.assign(head.map.size(), 0);
  head.completed[7] = 1;
  write_map_csv(folder.path / "map.csv", head);
  const std::string table = read_file(folder.path / "map.csv");
  const auto rows = parse_csv({"map.csv", table, {}});
  EXPECT_EQ(rows[0].cells.back(), "completed");
  for (std::size_t v = 0; v < head.map.size(); ++v)
    EXPECT_EQ(rows[v + 1].cells.back(), v == 7 ? "1" : "0");
  write_map_ply(folder.path / "map.ply", head);
  const std::string bytes = read_file(folder.path / "map.ply");
  const ParsedMesh marks = parse_ply({"map.ply", bytes, {}}, "completed");
  EXPECT_EQ(marks.property[6], 0);
  EXPECT_EQ(marks.property[7], 1);
  write_map_vtp(folder.path / "map.vtp", head);
  const std::string column = vtk_array(read_file(folder.path / "map.vtp"), "completed");
  EXPECT_EQ(column, std::string(head.completed.begin(), head.completed.end()));
}

TEST(Export, TissueComesBackFromMsh) {
  const TemporaryFolder folder;
  const TissueMesh wrote = sample_tissue();
  write_tissue(folder.path / "t.msh", wrote);
  const TissueMesh read = read_tissue(folder.path / "t.msh");
  EXPECT_EQ(read.nodes, wrote.nodes);
  EXPECT_EQ(read.tets, wrote.tets);
  EXPECT_EQ(read.label, wrote.label);
  EXPECT_EQ(read.skin_points, wrote.skin_points);
  EXPECT_EQ(read.held, wrote.held);
  EXPECT_EQ(read.quality, wrote.quality);
}

TEST(Export, AbaqusAndVegaNameTheirSets) {
  const TemporaryFolder folder;
  write_tissue(folder.path / "t.inp", sample_tissue());
  const std::string inp = read_file(folder.path / "t.inp");
  EXPECT_NE(inp.find("*ELEMENT, TYPE=C3D4, ELSET=FLESH\n1, 1, 2, 3, 4\n3, 1, 6, 2, 4\n"),
            std::string::npos);
  EXPECT_NE(inp.find("*ELEMENT, TYPE=C3D4, ELSET=BONE\n2, 1, 3, 5, 4\n"), std::string::npos);
  EXPECT_NE(inp.find("*NSET, NSET=SKIN\n1, 2\n*NSET, NSET=HELD\n3, 5\n"), std::string::npos);
  write_tissue(folder.path / "t.veg", sample_tissue());
  const std::string veg = read_file(folder.path / "t.veg");
  EXPECT_NE(veg.find("*VERTICES\n6 3 0 0\n1 0 0 0\n"), std::string::npos);
  EXPECT_NE(veg.find("*ELEMENTS\nTET\n3 4 0\n1 1 2 3 4\n"), std::string::npos);
  EXPECT_NE(veg.find("*SET FLESH\n1, 3\n"), std::string::npos);
  EXPECT_NE(veg.find("ENU, 1.06e-09, 0.045658, 0.43"), std::string::npos);
  EXPECT_THROW(write_tissue(folder.path / "t.xyz", sample_tissue()), InputError);
  TissueMesh broken = sample_tissue();
  broken.label.pop_back();
  EXPECT_THROW(write_tissue(folder.path / "t.msh", broken), InputError);
}

TEST(Base64, MatchesRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace palpate::io
