// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile files: refused in one line, never a crash, never a wrong mesh.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/error.hpp"
#include "io/head_file.hpp"
#include "io/tissue_formats.hpp"
#include "samples.hpp"

namespace palpate::io {
namespace {
using namespace test;

enum class Outcome { refused, same, different };

Outcome outcome(const SampleFile& file, std::string_view bytes, const SurfaceMesh& whole) {
  try {
    const ParsedMesh parsed = file.parse(Source{"test", bytes, {}});
    const bool same =
        parsed.mesh.points == whole.points && parsed.mesh.triangles == whole.triangles;
    return same ? Outcome::same : Outcome::different;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    return Outcome::refused;
  }
}

// A cut that only takes a line end or a trailing comment leaves the same mesh; every other one is
// refused. OBJ alone has neither a count nor an end mark: there, a cut at a line end can only be
// told where vertices lose all their faces.
TEST(Damage, CutAtEveryByteIsRefusedOrHarmless) {
  for (const SampleFile& file : sample_files(2)) {
    SCOPED_TRACE(file.label);
    const SurfaceMesh whole = file.parse(Source{"test", file.bytes, {}}).mesh;
    for (std::size_t cut = 0; cut < file.bytes.size(); ++cut) {
      const Outcome found = outcome(file, std::string_view(file.bytes).substr(0, cut), whole);
      if (file.label == "obj" && (file.bytes[cut] == '\n' || file.bytes[cut - 1] == '\n')) continue;
      EXPECT_NE(found, Outcome::different) << "cut at byte " << cut;
    }
  }
}

TEST(Damage, ObjCutInTheFirstHalfOfItsFacesIsRefused) {
  const std::string text = obj_text(ellipsoid(3));
  const std::size_t faces = text.find("\nf ");
  for (std::size_t cut = text.find('\n', faces + 1); cut < faces + (text.size() - faces) / 4;
       cut = text.find('\n', cut + 1))
    EXPECT_THROW((void)parse_obj(Source{"test", std::string_view(text).substr(0, cut + 1), {}}),
                 InputError)
        << cut;
}

TEST(Damage, CutTouchableHeadsAndTissuesAreRefused) {
  const std::string head = head_bytes(sample_head(0));
  for (std::size_t cut = 0; cut < head.size(); ++cut) {
    try {
      (void)parse_head(std::string_view(head).substr(0, cut), "test");
      ADD_FAILURE() << "read although cut at byte " << cut;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    }
  }
  const std::string msh = tissue_msh(sample_tissue());
  // The quality figures at the end are not needed.
  const std::size_t needed = msh.find("\n$PalpateQuality");
  for (std::size_t cut = 0; cut < needed; ++cut) {
    const auto part = std::string_view(msh).substr(0, cut);
    EXPECT_THROW((void)parse_tissue_msh({"test", part, {}}), InputError) << cut;
  }
}

// 64 MiB are enough for all small files below, whatever their headers announce.
class LimitedMemory {
 public:
  LimitedMemory() {
    ::getrlimit(RLIMIT_AS, &before_);
    rlimit limited = before_;
    limited.rlim_cur = used() + (std::size_t{64} << 20);
    ::setrlimit(RLIMIT_AS, &limited);
  }
  ~LimitedMemory() { ::setrlimit(RLIMIT_AS, &before_); }

 private:
  static std::size_t used() {
    std::size_t pages = 0;
    if (FILE* f = std::fopen("/proc/self/statm", "r")) {
      if (std::fscanf(f, "%zu", &pages) != 1) pages = 0;
      std::fclose(f);
    }
    return pages * 4096;
  }
  rlimit before_{};
};

TEST(Damage, HugeCountsAreRefusedWithoutAllocating) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer reserves more than any limit";
#endif
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nelement face {}\nproperty list {} int vertex_indices\nend_header\n";
  std::vector<std::pair<std::string, ParsedMesh (*)(const Source&)>> files;
  const auto read_ply = [](const Source& s) { return parse_ply(s); };
  const std::string triangle(36, '\0');
  for (const char* count :
       {"50000000", "4294967295", "9223372036854775807", "99999999999999999999999", "-1"}) {
    files.emplace_back(fmt::format(fmt::runtime(ply), count, 1, "uchar") + triangle, read_ply);
    files.emplace_back(fmt::format(fmt::runtime(ply), 3, count, "uchar") + triangle, read_ply);
    files.emplace_back(fmt::format("OFF\n{} 1 0\n0 0 0\n", count), parse_off);
    files.emplace_back(fmt::format("OFF\n1 {} 0\n0 0 0\n", count), parse_off);
    files.emplace_back(fmt::format("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{} 0 1 2\n", count),
                       parse_off);
    for (const char* key : {"count", "byteOffset", "byteLength", "bufferView"}) {
      std::string gltf = gltf_text(ellipsoid(0));
      for (std::size_t at = 0; (at = gltf.find(fmt::format("\"{}\"", key), at)) != gltf.npos;) {
        const std::size_t value = gltf.find(':', at) + 1;
        gltf.replace(value, gltf.find_first_of(",\n}", value) - value, count);
        at = value;
      }
      files.emplace_back(gltf, parse_gltf);
    }
  }
  // A list of two thousand million corners; a binary STL of four.
  files.emplace_back(fmt::format(fmt::runtime(ply), 3, 1, "uint") + triangle +
                         std::string("\xff\xff\xff\x7f\0\0\0\0", 8),
                     read_ply);
  std::string stl = stl_binary(ellipsoid(0));
  stl.replace(80, 4, "\xff\xff\xff\xff");
  files.emplace_back(stl, parse_stl);
  // JSON that is deep, or many values in few bytes.
  files.emplace_back("{\"asset\":" + std::string(100'000, '['), parse_gltf);
  const LimitedMemory limited;
  for (const auto& [bytes, parse] : files)
    EXPECT_THROW((void)parse(Source{"test", bytes, {}}), InputError) << bytes.substr(0, 2000);
}

TEST(Damage, LimitIsNamed) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 20000001\nproperty list uchar int vertex_indices\nend_header\n";
  try {
    (void)parse_ply({"test", text, {}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("20 million triangles"), std::string::npos);
  }
}

TEST(Damage, GltfTreesThatAreNoTreesAreRefused) {
  using json = nlohmann::ordered_json;
  const json good = json::parse(gltf_text(ellipsoid(0)));
  json loop = good, doubled = good, far = good;
  loop["nodes"] = json::parse(R"([{"children": [1]}, {"children": [0], "mesh": 0}])");
  doubled["nodes"] = json::parse(R"([{"children": [1, 1]}, {"mesh": 0}])");
  far["nodes"] = json::parse(R"([{"children": [7]}, {"mesh": 0}])");
  json strange = good;
  strange["extensionsRequired"] = json::array({"KHR_draco_mesh_compression"});
  for (const json& document : {loop, doubled, far, strange})
    EXPECT_THROW((void)parse_gltf({"test", document.dump(), {}}), InputError);
}

TEST(Damage, NotFiniteCoordinatesAreRefusedInEveryBinaryFormat) {
  SurfaceMesh mesh = ellipsoid(1);
  mesh.points[3].y() = std::numeric_limits<double>::quiet_NaN();
  mesh.points[4].z() = std::numeric_limits<double>::infinity();
  for (const bool big : {false, true})
    EXPECT_THROW((void)parse_ply({"test", ply_binary(mesh, big), {}}), InputError);
  EXPECT_THROW((void)parse_stl({"test", stl_binary(mesh), {}}), InputError);
  EXPECT_THROW((void)parse_ply({"test", ply_text(mesh), {}}), InputError);
  EXPECT_THROW((void)parse_off({"test", off_text(mesh), {}}), InputError);
  std::string glb = glb_bytes(ellipsoid(1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t length =
      static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
  glb.replace(28 + length + 4, 4, reinterpret_cast<const char*>(&nan), 4);
  EXPECT_THROW((void)parse_glb({"test", glb, {}}), InputError);
}

TEST(Damage, MutatedFilesGiveAMeshOrOneLine) {
  Random random(20240601);
  for (const SampleFile& file : sample_files(1))
    for (int i = 0; i < 3000; ++i) {
      const std::string bytes = mutated(file.bytes, random);
      try {
        const ParsedMesh parsed = file.parse(Source{"test", bytes, {}});
        ASSERT_FALSE(parsed.mesh.empty());
        ASSERT_EQ(first_defect(parsed.mesh), std::nullopt);
      } catch (const InputError& error) {
        ASSERT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
      }
    }
}

TEST(Damage, MutatedHeadsAndTissuesGiveAHeadOrOneLine) {
  Random random(20240602);
  const std::string head = head_bytes(sample_head(0)), msh = tissue_msh(sample_tissue());
  for (int i = 0; i < 3000; ++i) {
    try {
      const TouchableHead read = parse_head(mutated(head, random), "test");
      ASSERT_EQ(read.map.size(), read.skin.points.size());
      (void)head_bytes(read);  // what is read can be written
    } catch (const InputError& error) {
      ASSERT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    }
    try {
      (void)parse_tissue_msh({"test", mutated(msh, random), {}});
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace palpate::io
