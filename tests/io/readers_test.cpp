// SPDX-License-Identifier: Apache-2.0
// Each format read as its specification says, into the file's own vertices in order.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <clocale>

#include "core/error.hpp"
#include "io/scan.hpp"
#include "io/sha256.hpp"
#include "samples.hpp"

namespace palpate::io {
namespace {
using namespace test;

ParsedMesh read(ParsedMesh (*parse)(const Source&), std::string_view text) {
  return parse(Source{"test", text, {}});
}
ParsedMesh read_ply(const Source& s) {
  return parse_ply(s);
}

std::string refusal(ParsedMesh (*parse)(const Source&), std::string_view text) {
  try {
    read(parse, text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// STL has three points per facet; the others keep the shared ones.
void expect_same(const SurfaceMesh& found, const SurfaceMesh& wanted, bool soup) {
  ASSERT_EQ(found.triangles.size(), wanted.triangles.size());
  if (!soup) {
    EXPECT_EQ(found.points, wanted.points);
    EXPECT_EQ(found.triangles, wanted.triangles);
    return;
  }
  ASSERT_EQ(found.points.size(), 3 * wanted.triangles.size());
  for (std::size_t t = 0; t < wanted.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(found.triangles[t][k], static_cast<int>(3 * t) + k);
      EXPECT_EQ(found.points[3 * t + k].cast<float>(),
                wanted.points[wanted.triangles[t][k]].cast<float>());
    }
}

TEST(Readers, EveryFormatGivesTheFilesVerticesInOrder) {
  const SurfaceMesh wanted = ellipsoid(2);
  const TemporaryFolder folder;
  for (const SampleFile& file : sample_files(2)) {
    SCOPED_TRACE(file.label);
    const Scan scan = read_scan(folder.write("a." + file.extension, file.bytes));
    EXPECT_EQ(scan.format, file.extension);
    EXPECT_EQ(scan.sha256, sha256_hex(file.bytes));
    EXPECT_TRUE(scan.warnings.empty());
    expect_same(scan.mesh, wanted, file.extension == "stl");
  }
}

TEST(Readers, LineEndsAndMissingLastLineEndDoNotMatter) {
  const SurfaceMesh wanted = ellipsoid(1);
  for (const SampleFile& file : sample_files(1)) {
    if (file.bytes.find('\0') != std::string::npos || file.label == "gltf") continue;
    SCOPED_TRACE(file.label);
    for (const std::string end : {"\r\n", "\r"}) {
      std::string text;
      for (const char c : file.bytes) c == '\n' ? text += end : text += c;
      expect_same(read(file.parse, text).mesh, wanted, file.extension == "stl");
    }
    expect_same(read(file.parse, file.bytes.substr(0, file.bytes.size() - 1)).mesh, wanted,
                file.extension == "stl");
  }
}

TEST(Readers, NumbersDoNotDependOnTheLocale) {
  const char* const german = std::setlocale(LC_ALL, "de_DE.UTF-8");
  if (!german) GTEST_SKIP() << "the locale de_DE.UTF-8 is not installed";
  for (const SampleFile& file : sample_files(1))
    expect_same(read(file.parse, file.bytes).mesh, ellipsoid(1), file.extension == "stl");
  std::setlocale(LC_ALL, "C");
}

TEST(Obj, TakesAllFormsOfCornersAndSplitsPolygonsIntoFans) {
  const ParsedMesh m =
      read(parse_obj,
           "o one\nv 0 0 0 0.5 0.5 0.5\nv +1 0 0\nv 1 1 0 1.0\nv 0 1e0 -0\n"
           "vt 0 0\nvn 0 0 1\nf 1 2 3 4\n"
           "o two\nv 0 0 1\nv 1 0 1\nv 1 1 1\n"
           "f -3/1 -2/1 -1/1\nf 5//1 6//1 7//1\nf 1/1/1 \\\n 2/1/1 3/1/1 # note\n");
  EXPECT_EQ(m.mesh.points.size(), 7u);
  const std::vector<Triangle> wanted = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 5, 6}, {0, 1, 2}};
  EXPECT_EQ(m.mesh.triangles, wanted);
  EXPECT_EQ(m.mesh.points[3], Vec3(0, 1, 0));
}

TEST(Obj, NamesTheLineOfTheFirstBadElement) {
  EXPECT_NE(refusal(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1,5 0\n").find("line 3: '1,5'"),
            std::string::npos);
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_NE(refusal(parse_obj, three + "f 1 2\n").find("line 4: a face with 2 corners"),
            std::string::npos);
  EXPECT_NE(refusal(parse_obj, three + "f 1 2 0\n").find("line 4"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, three + "f -1 -2 -4\n").find("line 4"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, three + "f 1 2 4\n").find("vertex 3"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, three + "f 1/1 2 3\n").find("different forms"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, three).find("no faces"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, "v 0 0 nan\n").find("NaN or infinite"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, "v 0 0 1e999\n").find("NaN or infinite"), std::string::npos);
  EXPECT_NE(refusal(parse_obj, "w 1 2 3\n").find("not an OBJ statement"), std::string::npos);
}

TEST(Obj, WarnsOfVerticesWithoutFacesAndRefusesMostly) {
  const std::string four = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n";
  EXPECT_EQ(read(parse_obj, four).warnings.size(), 1u);
  EXPECT_NE(refusal(parse_obj, "v 1 1 1\nv 2 1 1\nv 1 2 1\nv 9 9 9\n" + four).find("cut"),
            std::string::npos);
}

TEST(Ply, ReadsAScalarPropertyOnRequest) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty int y\nproperty "
      "float z\nproperty uchar region\nelement face 1\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 0 7\n1 0 0 8\n0 1 0.5 9\n3 0 1 2\n";
  const ParsedMesh m = parse_ply({"test", text, {}}, "region");
  EXPECT_EQ(m.property, (std::vector<double>{7, 8, 9}));
  EXPECT_EQ(m.mesh.points[2], Vec3(0, 1, 0.5));
  EXPECT_THROW((void)parse_ply({"test", text, {}}, "colour"), InputError);
}

TEST(Ply, RefusesWhatItsHeaderDoesNotCover) {
  const std::string text = ply_text(ellipsoid(0));
  EXPECT_NE(refusal(read_ply, text + "1 2 3\n").find("goes on"), std::string::npos);
  const std::string binary = ply_binary(ellipsoid(0), false);
  EXPECT_NE(refusal(read_ply, binary + "more").find("goes on"), std::string::npos);
  std::string fraction = text;
  fraction.replace(fraction.rfind("3 0 3 5"), 7, "3 0 3.5");
  EXPECT_NE(refusal(read_ply, fraction).find("'3.5'"), std::string::npos);
  std::string strange = text;
  strange.replace(strange.find("float x"), 5, "quark");
  EXPECT_NE(refusal(read_ply, strange).find("header line 5"), std::string::npos);
}

TEST(Off, PassesOverColoursNormalsAndComments) {
  const ParsedMesh m = read(parse_off,
                            "# first\nCNOFF\n# counts\n4 1 0\n0 0 0 0 0 1 255 0 0 255\n"
                            "1 0 0 0 0 1 255 0 0 255 # red\n\n1 1 0 0 0 1 1 2 3 4\n"
                            "0 1 0 0 0 1 1 2 3 4\n4 0 1 2 3 0.5 0.5 0.5\n");
  EXPECT_EQ(m.mesh.points.size(), 4u);
  EXPECT_EQ(m.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_NE(refusal(parse_off, "OFF BINARY\n").find("binary OFF"), std::string::npos);
  EXPECT_NE(refusal(parse_off, "4OFF\n1 1 0\n").find("three-dimensional"), std::string::npos);
  EXPECT_NE(refusal(parse_off, "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").find("vertex 3"),
            std::string::npos);
  EXPECT_EQ(read(parse_off, "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").mesh.points.size(), 3u);
}

TEST(Stl, TellsTextFromBinaryByContentAndChecksTheCount) {
  std::string binary = stl_binary(ellipsoid(1));
  EXPECT_EQ(read(parse_stl, binary).mesh.triangles.size(), 32u);
  EXPECT_NE(refusal(parse_stl, binary + "x").find("announces 32 facets"), std::string::npos);
  std::string two = stl_text(ellipsoid(0)) + stl_text(ellipsoid(1));
  EXPECT_EQ(read(parse_stl, two).mesh.triangles.size(), 40u);
}

TEST(Gltf, AppliesNodeTransformsAndTurnsMirroredFacesRound) {
  using json = nlohmann::ordered_json;
  auto document = json::parse(gltf_text(ellipsoid(0)));
  document["nodes"] = json::parse(
      R"([{"children": [1, 2], "translation": [10, 0, 0]},
          {"mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
          {"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])");
  const ParsedMesh m = read(parse_gltf, document.dump());
  const SurfaceMesh one = ellipsoid(0);
  ASSERT_EQ(m.mesh.points.size(), 12u);
  for (int i = 0; i < 6; ++i) {
    const Vec3& p = one.points[i];
    EXPECT_LT((m.mesh.points[i] - Vec3(10 - 2 * p.y(), 2 * p.x(), 2 * p.z())).norm(), 1e-9);
    EXPECT_LT((m.mesh.points[6 + i] - Vec3(10 - p.x(), p.y(), p.z() + 5)).norm(), 1e-9);
  }
  SurfaceMesh first = m.mesh, second = m.mesh;
  first.triangles.resize(8);
  second.triangles.erase(second.triangles.begin(), second.triangles.begin() + 8);
  EXPECT_NEAR(signed_volume(first), 8 * signed_volume(one), 1e-3);
  EXPECT_NEAR(signed_volume(second), signed_volume(one), 1e-3);
}

TEST(Gltf, ReadsStripsFansAndBytesAndSharesPointsOfAPrimitive) {
  using json = nlohmann::ordered_json;
  const std::string points("\0\0\0\0\x7f\0\0\0\x7f\x7f\0\0\0\x7f\0\0", 16);  // bytes, stride 4
  json document = json::parse(R"({"asset": {"version": "2.0"},
    "extensionsRequired": ["KHR_mesh_quantization"],
    "bufferViews": [{"buffer": 0, "byteLength": 16, "byteStride": 4}],
    "accessors": [{"bufferView": 0, "componentType": 5120, "count": 4, "type": "VEC3",
                   "normalized": true}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5},
                               {"attributes": {"POSITION": 0}, "mode": 6},
                               {"attributes": {"POSITION": 0}, "mode": 1}]}],
    "nodes": [{"mesh": 0}]})");
  document["buffers"] =
      json::array({{{"byteLength", 16}, {"uri", "data:;base64,AAAAAH8AAAB/fwAAAH8AAA=="}}});
  const ParsedMesh m = read(parse_gltf, document.dump());
  EXPECT_EQ(m.mesh.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(m.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {0, 1, 2}, {0, 2, 3}}));
}

TEST(Gltf, ReadsAndHashesABufferBesideItAndNothingElsewhere) {
  using json = nlohmann::ordered_json;
  const TemporaryFolder folder;
  const std::string glb = glb_bytes(ellipsoid(1));
  const std::size_t length =
      static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
  const std::string buffer = glb.substr(28 + length);
  folder.write("a b.bin", buffer);
  json document = json::parse(glb.substr(20, length));
  document["buffers"][0]["uri"] = "a%20b.bin";
  const Scan scan = read_scan(folder.write("a.gltf", document.dump()));
  EXPECT_EQ(scan.mesh.triangles, ellipsoid(1).triangles);
  EXPECT_EQ(scan.sha256, sha256_hex(document.dump() + buffer));
  for (const char* uri : {"/etc/passwd", "../a.bin", "https://example.org/a.bin", "%2e%2e/a", ""}) {
    document["buffers"][0]["uri"] = uri;
    EXPECT_NE(refusal(parse_gltf, document.dump()).find("beside the scan"), std::string::npos);
  }
}

TEST(Scan, RefusesContentThatIsNotWhatTheExtensionSays) {
  const TemporaryFolder folder;
  for (const SampleFile& file : sample_files(1))
    for (const char* extension : {"obj", "ply", "stl", "off", "gltf", "glb"}) {
      if (file.extension == extension) continue;
      SCOPED_TRACE(file.label + " as " + extension);
      try {
        (void)read_scan(folder.write(fmt::format("a.{}", extension), file.bytes));
        ADD_FAILURE() << "accepted";
      } catch (const InputError& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find(fmt::format("content is {}, not {}", file.extension, extension)),
                  std::string::npos)
            << what;
        EXPECT_EQ(what.find('\n'), std::string::npos);
      }
    }
  EXPECT_THROW((void)read_scan(folder.write("a.ply", "PK\x03\x04zip")), InputError);
  EXPECT_THROW((void)read_scan(folder.write("a.obj", "<html><body>404</body></html>")), InputError);
  EXPECT_THROW((void)read_scan(folder.write("a.xyz", "1 2 3\n")), InputError);
  EXPECT_THROW((void)read_scan(folder.path / "absent.ply"), InputError);
  EXPECT_THROW((void)read_scan(folder.path), InputError);
  for (const char* extension : {"obj", "ply", "stl", "off", "gltf", "glb"})
    EXPECT_THROW((void)read_scan(folder.write(fmt::format("empty.{}", extension), "")), InputError);
}

TEST(Sha256, MatchesThePublishedVectors) {
  // FIPS 180-4 examples and the million-a vector of NIST's test suite.
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  const std::string million(1'000'000, 'a');
  EXPECT_EQ(sha256_hex(million),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  Sha256 pieces;  // the same in pieces of changing length
  for (std::size_t at = 0, n = 1; at < million.size(); at += n, n = n % 131 + 1)
    pieces.add(std::string_view(million).substr(at, n));
  EXPECT_EQ(pieces.hex(), sha256_hex(million));
}

}  // namespace
}  // namespace palpate::io
