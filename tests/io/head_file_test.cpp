// SPDX-License-Identifier: Apache-2.0
// head.glb there and back, its place in the world, and the Khronos validator where it is installed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/byte_reader.hpp"
#include "io/fit_file.hpp"
#include "io/gltf_document.hpp"
#include "io/head_file.hpp"
#include "io/scan.hpp"
#include "io/stiffness_colour.hpp"
#include "samples.hpp"

namespace palpate::io {
namespace {
using namespace test;
using nlohmann::json;

void expect_equal_or_nan(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << i;
}

json chunk_json(std::string_view glb) {
  return json::parse(glb.substr(20, load<std::uint32_t>(glb.data() + 12)));
}

TEST(HeadFile, GivesBackWhatWasWritten) {
  const TouchableHead wrote = sample_head();
  const TemporaryFolder folder;
  write_head(folder.path / "a.glb", wrote);
  const TouchableHead read = read_head(folder.path / "a.glb");
  EXPECT_EQ(read.skin.points, wrote.skin.points);
  EXPECT_EQ(read.skin.triangles, wrote.skin.triangles);
  EXPECT_EQ(read.skull.points, wrote.skull.points);
  EXPECT_EQ(read.skull.triangles, wrote.skull.triangles);
  EXPECT_EQ(read.skull_region, wrote.skull_region);
  EXPECT_EQ(read.unit_mm, wrote.unit_mm);
  EXPECT_EQ(read.frame.rotation, wrote.frame.rotation);
  EXPECT_EQ(read.frame.origin, wrote.frame.origin);
  ASSERT_EQ(read.landmarks.size(), 2u);
  EXPECT_EQ(read.landmarks.at("nose_tip").position, wrote.landmarks.at("nose_tip").position);
  EXPECT_EQ(read.landmarks.at("nose_tip").confidence, 0.75);
  ASSERT_EQ(read.depths.size(), 2u);
  EXPECT_EQ(read.depths[0].depth_mm, 5.25);
  EXPECT_TRUE(std::isnan(read.depths[1].depth_mm));
  EXPECT_FALSE(read.depths[1].reached);
  EXPECT_EQ(read.map.tool_radius, 8);
  EXPECT_EQ(read.map.forces, wrote.map.forces);
  EXPECT_EQ(read.map.status, wrote.map.status);
  EXPECT_EQ(read.map.region, wrote.map.region);
  expect_equal_or_nan(read.map.depth, wrote.map.depth);
  expect_equal_or_nan(read.map.error, wrote.map.error);
  expect_equal_or_nan(read.map.displacement, wrote.map.displacement);
  EXPECT_EQ(read.provenance, wrote.provenance);
  EXPECT_EQ(read.run, wrote.run);
  EXPECT_EQ(head_bytes(read), head_bytes(wrote));
}

TEST(HeadFile, KeepsTheSpreadAndRefusesOneOfAnotherLength) {
  TouchableHead head = sample_head();
  head.spread.depth.assign(head.map.size(), 1.5);
  head.spread.stiffness.assign(head.map.size(), 0.25);
  head.spread.depth[1] = head.spread.stiffness[1] = std::nan("");
  head.skull_spread.assign(head.skull.points.size(), 2);
  const TouchableHead read = parse_head(head_bytes(head), "a.glb");
  expect_equal_or_nan(read.spread.depth, head.spread.depth);
  expect_equal_or_nan(read.spread.stiffness, head.spread.stiffness);
  expect_equal_or_nan(read.skull_spread, head.skull_spread);
  head.spread.stiffness.pop_back();
  EXPECT_THROW((void)head_bytes(head), InputError);
}

TEST(HeadFile, KeepsTheMarksOfACompletedFaceAndRefusesOnesOfAnotherLength) {
  TouchableHead head = sample_head();
  EXPECT_TRUE(parse_head(head_bytes(head), "a.glb").completed.empty());
  head.completed.assign(head.map.size(), 0);
  head.completed[2] = 1;
  EXPECT_EQ(parse_head(head_bytes(head), "a.glb").completed, head.completed);
  head.completed.pop_back();
  EXPECT_THROW((void)head_bytes(head), InputError);
}

TEST(HeadFile, DiffersBetweenEqualRunsInTheRunObjectOnly) {
  TouchableHead one = sample_head(), two = sample_head();
  two.run = {{"threads", 1}, {"seconds", {{"sweep", 987654.321}, {"report", 1}}}};
  const std::string a = head_bytes(one), b = head_bytes(two);
  EXPECT_NE(a, b);
  EXPECT_EQ(head_bytes_without_run(a, "a"), head_bytes_without_run(b, "b"));
  // It is the last thing in the JSON: the bytes before and behind it are the same.
  const std::size_t at = a.find("\"run\":");
  EXPECT_EQ(a.substr(20, at - 20), b.substr(20, at - 20));
  const auto binary = [](const std::string& s) {
    return s.substr(20 + load<std::uint32_t>(s.data() + 12));
  };
  EXPECT_EQ(binary(a), binary(b));
  one.run = json::object();
  EXPECT_EQ(head_bytes_without_run(a, "a"), head_bytes(one));
  two.map.depth[0] += 1;
  EXPECT_NE(head_bytes_without_run(head_bytes(two), "b"), head_bytes_without_run(a, "a"));
}

TEST(HeadFile, NodesTakeScanNumbersToMetresWithUpAndFront) {
  const TouchableHead head = sample_head();
  const json document = chunk_json(head_bytes(head));
  for (const auto& [index, unit] : {std::pair{0, head.unit_mm}, std::pair{1, 1.0}}) {
    const json& node = document["nodes"][index];
    const auto numbers = [&](const char* key) { return node[key].get<std::vector<double>>(); };
    const auto t = numbers("translation"), r = numbers("rotation"), s = numbers("scale");
    const Vec3 scan(3, -4, 5);
    const Vec3 metres =
        Eigen::Quaterniond(r[3], r[0], r[1], r[2]) * (s[0] * scan) + Vec3(t[0], t[1], t[2]);
    EXPECT_LT((metres - 0.001 * head.frame.to_head(unit * scan)).norm(), 1e-12);
  }
}

TEST(HeadFile, StandsForTheScanThatItWasMadeFrom) {
  const TouchableHead head = sample_head();
  const TemporaryFolder folder;
  write_head(folder.path / "head.glb", head);
  const Scan scan = read_scan(folder.path / "head.glb");
  EXPECT_EQ(scan.mesh.points, head.skin.points) << "its own numbers, no frame, no skull";
  EXPECT_EQ(scan.mesh.triangles, head.skin.triangles);
  EXPECT_EQ(scan.unit_mm, head.unit_mm);
  std::string bytes = head_bytes(head);
  bytes.replace(bytes.find("\"unit_mm\":8"), 11, "\"unit_mm\":0");
  EXPECT_THROW((void)read_scan(folder.write("none.glb", bytes)), InputError);
}

TEST(FitFile, HoldsSkullDepthsAndLandmarksInTheScansFrame) {
  const TouchableHead head = sample_head();
  FittedSkull fit{head.skull, head.map.depth, head.map.region, head.landmarks, {"a warning"}};
  const TemporaryFolder folder;
  write_fit(folder.path / "fit.glb", fit);
  const std::string bytes = read_file(folder.path / "fit.glb");
  const json document = chunk_json(bytes);
  const json& facts = document["extras"]["palpate_fit"];
  EXPECT_EQ(facts["warnings"], json({"a warning"}));
  EXPECT_EQ(facts["landmarks"]["nose_tip"]["position_mm"], json({0.1, 2, 95}));
  const std::size_t depth = document["meshes"][1]["primitives"][0]["attributes"]["_DEPTH"];
  const json& accessor = document["accessors"][depth];
  ASSERT_EQ(accessor["count"], fit.depth.size());
  const std::size_t view = accessor["bufferView"];
  const std::size_t start = 28 + load<std::uint32_t>(bytes.data() + 12) +
                            document["bufferViews"][view].value("byteOffset", std::size_t{0});
  for (std::size_t v = 0; v < fit.depth.size(); ++v) {
    const auto stored = load<float>(bytes.data() + start + 4 * v);
    EXPECT_EQ(stored, std::isfinite(fit.depth[v]) ? static_cast<float>(fit.depth[v]) : -1.0f);
  }
  Scan skull = read_scan(folder.path / "fit.glb");  // in metres
  ASSERT_EQ(skull.mesh.points.size(), fit.skull.points.size());
  for (std::size_t i = 0; i < fit.skull.points.size(); ++i)
    EXPECT_LT((1000 * skull.mesh.points[i] - fit.skull.points[i]).norm(), 1e-9);
  fit.region.pop_back();
  EXPECT_THROW(write_fit(folder.path / "bad.glb", fit), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "bad.glb"));
}

TEST(HeadFile, StoresCoefficientsThatGiveTheForceBack) {
  const TouchableHead head = sample_head();
  const std::string bytes = head_bytes(head);
  const Source source{"test", bytes, {}};
  const GltfDocument document = GltfDocument::from_glb(source);
  const json attributes = document.root()["meshes"][0]["primitives"][0]["attributes"];
  const auto at = [&](const std::string& name, std::size_t v) {
    return document.accessor(attributes[name].get<std::uint64_t>()).value(v, 0);
  };
  for (std::size_t v = 0; v < head.map.size(); ++v)
    for (std::size_t i = 1; i <= head.map.forces.size(); ++i) {
      const double u = at(fmt::format("_U_{}", i), v);
      const double f = at(fmt::format("_K_{}", i), v) * u + at(fmt::format("_B_{}", i), v);
      if (head.map.has_curve(v)) {
        EXPECT_NEAR(f, head.map.forces[i - 1], 1e-5);
      } else {
        EXPECT_EQ(u, -1);
        EXPECT_EQ(f, 0);
      }
    }
}

TEST(HeadFile, RefusesInconsistentHeads) {
  TouchableHead descending = sample_head();
  descending.map.displacement[1] = descending.map.displacement[0];
  EXPECT_THROW((void)head_bytes(descending), InputError);
  TouchableHead shorter = sample_head();
  shorter.map.depth.pop_back();
  EXPECT_THROW((void)head_bytes(shorter), InputError);
  TouchableHead far = sample_head();
  far.skin.points[5].x() = 1e300;
  EXPECT_THROW((void)head_bytes(far), InputError);
  EXPECT_THROW((void)parse_head(glb_bytes(ellipsoid(1)), "scan.glb"), InputError);
}

TEST(HeadFile, WithoutSkullOrCurvesIsStillAHead) {
  TouchableHead head = sample_head();
  head.skull = {};
  head.skull_region.clear();
  std::fill(head.map.status.begin(), head.map.status.end(), VertexStatus::no_bone);
  const TouchableHead read = parse_head(head_bytes(head), "test");
  EXPECT_TRUE(read.skull.empty());
  EXPECT_TRUE(std::isnan(read.map.displacement[0]));
}

TEST(StiffnessColour, InterpolatesTravelAndIsGreyWithoutACurve) {
  StiffnessMap map;
  map.forces = {1, 3};
  map.displacement = {2, 4, 1, 2, NAN, NAN};
  map.status = {VertexStatus::solved, VertexStatus::blended, VertexStatus::held};
  EXPECT_DOUBLE_EQ(secant_stiffness(map, 0, 2), 2.0 / 3);
  EXPECT_DOUBLE_EQ(secant_stiffness(map, 0, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(secant_stiffness(map, 0, 9), 0.75);
  EXPECT_TRUE(std::isnan(secant_stiffness(map, 2, 2)));
  const StiffnessColours colours = stiffness_colours(map);
  EXPECT_EQ(colours.colour[0], (Rgb{0x44, 0x01, 0x54}));  // the softest
  EXPECT_EQ(colours.colour[1], (Rgb{0xfd, 0xe7, 0x25}));
  EXPECT_EQ(colours.colour[2], (Rgb{0xa0, 0xa0, 0xa0}));
}

// npm install --prefix DIR gltf-validator, then GLTF_VALIDATOR=DIR/node_modules/gltf-validator.
TEST(HeadFile, HasNoErrorsOrWarningsInTheKhronosValidator) {
  const char* const validator = std::getenv("GLTF_VALIDATOR");
  if (!validator) GTEST_SKIP() << "GLTF_VALIDATOR does not name npm's gltf-validator folder";
  if (std::system("node --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no node";
  const TemporaryFolder folder;
  TouchableHead lonely = sample_head();  // with a vertex that no triangle uses
  lonely.skin.triangles.erase(lonely.skin.triangles.begin(), lonely.skin.triangles.begin() + 40);
  write_head(folder.path / "a.glb", sample_head());
  write_head(folder.path / "b.glb", lonely);
  const auto script = folder.write(
      "check.js", fmt::format(R"(
const validator = require({}), fs = require('fs');
for (const name of ['a.glb', 'b.glb'])
  validator.validateBytes(new Uint8Array(fs.readFileSync({} + '/' + name))).then(r => {{
    console.log(JSON.stringify(r.issues, null, 1));
    if (r.issues.numErrors || r.issues.numWarnings) process.exitCode = 1;
  }});
)",
                              json(validator).dump(), json(folder.path.string()).dump()));
  EXPECT_EQ(std::system(fmt::format("node '{}'", script.string()).c_str()), 0);
}

}  // namespace
}  // namespace palpate::io
