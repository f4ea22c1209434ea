// SPDX-License-Identifier: Apache-2.0
#include "samples.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <map>

#include "core/atomic_file.hpp"
#include "io/byte_reader.hpp"
#include "io/glb_writer.hpp"
#include "io/vtk_xml.hpp"

namespace palpate::io::test {

SurfaceMesh ellipsoid(int levels) {
  SurfaceMesh mesh;
  mesh.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, std::int32_t> middle;
    const auto split = [&](std::int32_t a, std::int32_t b) {
      const auto [at, is_new] =
          middle.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.points.size()));
      if (is_new) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : mesh.triangles) {
      const std::int32_t ab = split(t[0], t[1]), bc = split(t[1], t[2]), ca = split(t[2], t[0]);
      for (const Triangle& f : {Triangle{t[0], ab, ca}, Triangle{t[1], bc, ab},
                                Triangle{t[2], ca, bc}, Triangle{ab, bc, ca}})
        finer.push_back(f);
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& p : mesh.points)
    p = Vec3(75 * p.x(), 120 * p.y(), 95 * p.z()).cast<float>().cast<double>();
  return mesh;
}

TouchableHead sample_head(int levels) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  TouchableHead head;
  head.skin = ellipsoid(levels);
  for (Vec3& p : head.skin.points) p /= 8;  // a power of two, so that floats stay exact
  head.unit_mm = 8;
  head.frame.rotation = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  head.frame.origin = Vec3(1.5, -2, 80);
  head.landmarks["nose_tip"] = {Vec3(0.1, 2, 95), 0.75};
  head.landmarks["eye_outer_left"] = {Vec3(45, 30.5, 70), 1};
  head.skull = ellipsoid(levels);
  for (Vec3& p : head.skull.points) p = (0.75 * p).cast<float>().cast<double>();
  for (std::size_t i = 0; i < head.skull.points.size(); ++i)
    head.skull_region.push_back(static_cast<SkullRegion>(i % kSkullRegionNames.size()));
  head.depths = {{"g", 5.5, 1, 5.25, true}, {"me", 7, 2, kNaN, false}};
  StiffnessMap& map = head.map;
  map.tool_radius = 8;
  for (int i = 1; i <= 10; ++i) map.forces.push_back(0.5 * i);
  for (std::size_t v = 0; v < head.skin.points.size(); ++v) {
    map.status.push_back(static_cast<VertexStatus>(v % kVertexStatusNames.size()));
    map.region.push_back(static_cast<SkinRegion>(v % kSkinRegionNames.size()));
    const bool curve = map.has_curve(v);
    map.error.push_back(map.status[v] == VertexStatus::blended ? 0.125 : kNaN);
    map.depth.push_back(map.status[v] == VertexStatus::no_bone ? kNaN
                                                               : 4 + static_cast<double>(v % 9));
    const double limit = 2 + static_cast<double>(v % 9);  // [mm] the travel levels off
    for (const double f : map.forces)
      map.displacement.push_back(
          curve ? static_cast<double>(static_cast<float>(limit * f / (f + 2))) : kNaN);
  }
  head.provenance = {{"input", {{"name", "head.obj"}, {"sha256", "0123"}}},
                     {"options", {{"sites", 600}, {"tool_radius_mm", 8.0}}}};
  head.run = {{"threads", 2}, {"seconds", {{"sweep", 12.5}}}};
  return head;
}

TissueMesh sample_tissue() {
  TissueMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1.0 / 3, 0}, {0, 0, 1}, {-1, 0, 0.1}, {0, -1, 0}};
  mesh.tets = {{0, 1, 2, 3}, {0, 2, 4, 3}, {0, 5, 1, 3}};
  mesh.label = {TissueLabel::flesh, TissueLabel::bone, TissueLabel::flesh};
  mesh.skin_points = 2;
  mesh.held = {0, 0, 1, 0, 1, 0};
  mesh.quality = {{"smallest_dihedral_deg", 12.25}, {"volume_mm3", 0.1}};
  return mesh;
}

std::string ply_text(const SurfaceMesh& mesh) {
  std::string out = fmt::format(
      "ply\nformat ascii 1.0\ncomment made by a test\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nelement face {}\nproperty list uchar int "
      "vertex_indices\nend_header\n",
      mesh.points.size(), mesh.triangles.size());
  for (const Vec3& p : mesh.points) out += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  for (const Triangle& t : mesh.triangles) out += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return out;
}

template <typename T>
static void put(std::string& out, T value, bool big_endian = false) {
  if (big_endian) value = reversed(value);
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

// Coordinates of mixed types in another order, properties and elements in between.
std::string ply_binary(const SurfaceMesh& mesh, bool big) {
  std::string out = fmt::format(
      "ply\r\nformat binary_{}_endian 1.0\r\nelement camera 1\r\nproperty list ushort short "
      "settings\r\nelement vertex {}\r\nproperty uchar red\r\nproperty double z\r\nproperty "
      "float x\r\nproperty list uchar float weights\r\nproperty float64 y\r\nelement face "
      "{}\r\nproperty list uchar float uv\r\nproperty list int uint vertex_index\r\nproperty "
      "ushort group\r\nend_header\r\n",
      big ? "big" : "little", mesh.points.size(), mesh.triangles.size());
  put(out, std::uint16_t{2}, big);
  put(out, std::int16_t{7}, big);
  put(out, std::int16_t{-7}, big);
  for (const Vec3& p : mesh.points) {
    put(out, std::uint8_t{200});
    put(out, p.z(), big);
    put(out, static_cast<float>(p.x()), big);
    put(out, std::uint8_t{1});
    put(out, 0.5f, big);
    put(out, p.y(), big);
  }
  for (const Triangle& t : mesh.triangles) {
    put(out, std::uint8_t{2});
    put(out, 0.25f, big);
    put(out, 0.75f, big);
    put(out, std::int32_t{3}, big);
    for (const std::int32_t c : t) put(out, static_cast<std::uint32_t>(c), big);
    put(out, std::uint16_t{1}, big);
  }
  return out;
}

std::string obj_text(const SurfaceMesh& mesh) {
  std::string out = "# made by a test\nmtllib a.mtl\no head\n";
  for (const Vec3& p : mesh.points) out += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
  out += "vt 0 0\nusemtl skin\ns off\n";
  for (const Triangle& t : mesh.triangles)
    out += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

std::string off_text(const SurfaceMesh& mesh) {
  std::string out =
      fmt::format("OFF # made by a test\n{} {} 0\n", mesh.points.size(), mesh.triangles.size());
  for (const Vec3& p : mesh.points) out += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  out += "# faces\n";
  for (const Triangle& t : mesh.triangles) out += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return out;
}

std::string stl_text(const SurfaceMesh& mesh) {
  std::string out = "solid head\n";
  for (const Triangle& t : mesh.triangles) {
    out += "facet normal 0 0 1\n  outer loop\n";
    for (const std::int32_t c : t) {
      const Vec3& p = mesh.points[c];
      out += fmt::format("    vertex {:.9e} {:.9e} {:.9e}\n", p.x(), p.y(), p.z());
    }
    out += "  endloop\nendfacet\n";
  }
  return out + "endsolid head\n";
}

std::string stl_binary(const SurfaceMesh& mesh) {
  std::string out = "solid is how some binary files begin, too";
  out.resize(80);
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) put(out, 0.f);
    for (const std::int32_t c : t)
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>(mesh.points[c][k]));
    put(out, std::uint16_t{0});
  }
  return out;
}

static nlohmann::ordered_json gltf_document(const SurfaceMesh& mesh, GlbWriter& glb) {
  std::vector<float> points;
  std::vector<std::uint32_t> corners;
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>(p[k]));
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  using json = nlohmann::ordered_json;
  json primitive;
  primitive["attributes"]["POSITION"] = glb.add_floats(points, 3, true);
  primitive["indices"] = glb.add_indices(corners);
  json document;
  document["asset"]["version"] = "2.0";
  document["meshes"] = json::array({{{"primitives", json::array({primitive})}}});
  document["nodes"] = json::array({{{"mesh", 0}}});
  document["scenes"] = json::array({{{"nodes", json::array({0})}}});
  return document;
}

std::string glb_bytes(const SurfaceMesh& mesh) {
  GlbWriter glb;
  const auto document = gltf_document(mesh, glb);
  return glb.finish(document);
}

std::string gltf_text(const SurfaceMesh& mesh) {
  const std::string glb = glb_bytes(mesh);
  const auto length = load<std::uint32_t>(glb.data() + 12);
  auto document = nlohmann::ordered_json::parse(glb.substr(20, length));
  document["buffers"][0]["uri"] =
      "data:application/octet-stream;base64," + base64(glb.substr(20 + length + 8));
  return document.dump(1);
}

std::vector<SampleFile> sample_files(int levels) {
  const SurfaceMesh mesh = ellipsoid(levels);
  const auto ply = [](const Source& s) { return parse_ply(s); };
  return {{"obj", "obj", obj_text(mesh), parse_obj},
          {"ply", "ply_text", ply_text(mesh), ply},
          {"ply", "ply_little", ply_binary(mesh, false), ply},
          {"ply", "ply_big", ply_binary(mesh, true), ply},
          {"off", "off", off_text(mesh), parse_off},
          {"stl", "stl_text", stl_text(mesh), parse_stl},
          {"stl", "stl_binary", stl_binary(mesh), parse_stl},
          {"gltf", "gltf", gltf_text(mesh), parse_gltf},
          {"glb", "glb", glb_bytes(mesh), parse_glb}};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "palpate-io-").string() +
                     std::string(6, 'X');  // mkdtemp replaces them
  if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  path = name;
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}
std::filesystem::path TemporaryFolder::write(const std::string& name,
                                             const std::string& bytes) const {
  write_file(path / name, bytes);
  return path / name;
}

std::string mutated(std::string bytes, Random& random) {
  static const char* const kWords[] = {
      "-1", "0", "4294967295", "2147483648",           "nan",   "inf", "1e999", " ", "\n", "{", "[",
      "\"", "/", "#",          "99999999999999999999", "1e-999"};
  const std::size_t edits = 1 + random.below(4);
  for (std::size_t e = 0; e < edits && !bytes.empty(); ++e) {
    const std::size_t at = random.below(bytes.size());
    switch (random.below(7)) {
      case 0:
        bytes[at] = static_cast<char>(random.next());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 2:
        bytes.erase(at, 1 + random.below(20));
        break;
      case 3:
        bytes.insert(at, bytes.substr(random.below(bytes.size()), 1 + random.below(40)));
        break;
      case 4:
        bytes.replace(at, random.below(5), kWords[random.below(std::size(kWords))]);
        break;
      case 5: {  // a word of 32 bits, small, huge or the sign bit
        const std::uint32_t values[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000};
        const std::uint32_t value = values[random.below(std::size(values))];
        if (at + 4 <= bytes.size()) bytes.replace(at, 4, reinterpret_cast<const char*>(&value), 4);
        break;
      }
      default:
        if (random.below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

}  // namespace palpate::io::test
