// SPDX-License-Identifier: Apache-2.0
#include "io/glb_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace palpate::io {

using json = nlohmann::ordered_json;

namespace {
constexpr int kVertexTarget = 34962, kIndexTarget = 34963;
constexpr int kUnsignedByte = 5121, kUnsignedInt = 5125, kFloat = 5126;
constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
// Both chunks' and the file's lengths are 32 bit; the JSON gets the rest.
constexpr std::size_t kMaxBinary = (std::size_t{4} << 30) - (std::size_t{64} << 20);

void append_u32(std::string& out, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<char>(v >> (8 * i)));
}
}  // namespace

std::size_t GlbWriter::add(const void* data, std::size_t bytes, int target, json accessor) {
  if (bytes > kMaxBinary || binary_.size() > kMaxBinary - bytes)
    throw InputError(
        "the touchable head would be larger than 4 GiB, which GLB cannot hold; "
        "decimate the scan or join its vertices");
  accessor["bufferView"] = views_.size();
  views_.push_back(
      {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}, {"target", target}});
  accessors_.push_back(std::move(accessor));
  binary_.append(static_cast<const char*>(data), bytes);
  binary_.append((4 - bytes % 4) % 4, '\0');
  return accessors_.size() - 1;
}

std::size_t GlbWriter::add_floats(std::span<const float> values, int components, bool with_bounds) {
  const auto width = static_cast<std::size_t>(components);
  json accessor = {
      {"componentType", kFloat}, {"count", values.size() / width}, {"type", kTypes[components]}};
  if (with_bounds) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    std::array<float, 4> low, high;
    low.fill(inf);
    high.fill(-inf);
    for (std::size_t i = 0; i < values.size(); ++i) {
      low[i % width] = std::min(low[i % width], values[i]);
      high[i % width] = std::max(high[i % width], values[i]);
    }
    for (std::size_t c = 0; c < width; ++c) {
      accessor["min"].push_back(static_cast<double>(low[c]));
      accessor["max"].push_back(static_cast<double>(high[c]));
    }
  }
  return add(values.data(), values.size_bytes(), kVertexTarget, std::move(accessor));
}

std::size_t GlbWriter::add_colours(std::span<const std::uint8_t> rgba) {
  return add(rgba.data(), rgba.size_bytes(), kVertexTarget,
             {{"componentType", kUnsignedByte},
              {"normalized", true},
              {"count", rgba.size() / 4},
              {"type", "VEC4"}});
}

std::size_t GlbWriter::add_indices(std::span<const std::uint32_t> values) {
  return add(values.data(), values.size_bytes(), kIndexTarget,
             {{"componentType", kUnsignedInt}, {"count", values.size()}, {"type", "SCALAR"}});
}

std::string GlbWriter::finish(json document) const {
  document["accessors"] = accessors_;
  document["bufferViews"] = views_;
  document["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  if (document.contains("extensions")) {  // last, so that `run` ends the JSON
    json extensions = std::move(document["extensions"]);
    document.erase("extensions");
    document["extensions"] = std::move(extensions);
  }
  return join_glb(document, binary_);
}

std::string join_glb(const json& document, std::string_view binary) {
  // A path in the provenance may hold bytes that are not UTF-8; they become U+FFFD.
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');
  std::string out = "glTF";
  append_u32(out, 2);
  append_u32(out, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + binary.size()));
  append_u32(out, static_cast<std::uint32_t>(text.size()));
  out += "JSON";
  out += text;
  append_u32(out, static_cast<std::uint32_t>(binary.size()));
  out.append("BIN\0", 4);
  out += binary;
  return out;
}

std::vector<float> glb_vectors(const std::vector<Vec3>& vectors) {
  std::vector<float> out;
  out.reserve(3 * vectors.size());
  for (const Vec3& v : vectors)
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<float>(v[k]));
  return out;
}

std::vector<float> glb_normals(const SurfaceMesh& mesh) {
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (Vec3& n : normals)
    if (!(n.squaredNorm() > 0.5)) n = Vec3::UnitZ();
  return glb_vectors(normals);
}

std::vector<std::uint32_t> glb_corners(const SurfaceMesh& mesh) {
  std::vector<std::uint32_t> out;
  out.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t c : t) out.push_back(static_cast<std::uint32_t>(c));
  return out;
}

float glb_or_missing(double value) {
  return std::isfinite(value) ? static_cast<float>(value) : -1.0f;
}

}  // namespace palpate::io
