// SPDX-License-Identifier: GPL-3.0-or-later
// NRRD (https://teem.sourceforge.net/nrrd/format.html): a text header, then voxels, in one file or
// two.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "core/atomic_file.hpp"
#include "image/voxels.hpp"

namespace palpate::image {
namespace {

constexpr std::size_t kMostHeader = 1 << 20;  // [byte]
const std::string kAnew = "write it anew with three axes";

const std::map<std::string, VoxelType> kTypes = {
    {"signed char", VoxelType::i8},   {"int8", VoxelType::i8},
    {"int8_t", VoxelType::i8},        {"uchar", VoxelType::u8},
    {"unsigned char", VoxelType::u8}, {"uint8", VoxelType::u8},
    {"uint8_t", VoxelType::u8},       {"short", VoxelType::i16},
    {"short int", VoxelType::i16},    {"signed short", VoxelType::i16},
    {"int16", VoxelType::i16},        {"int16_t", VoxelType::i16},
    {"ushort", VoxelType::u16},       {"unsigned short", VoxelType::u16},
    {"uint16", VoxelType::u16},       {"uint16_t", VoxelType::u16},
    {"int", VoxelType::i32},          {"signed int", VoxelType::i32},
    {"int32", VoxelType::i32},        {"int32_t", VoxelType::i32},
    {"uint", VoxelType::u32},         {"unsigned int", VoxelType::u32},
    {"uint32", VoxelType::u32},       {"uint32_t", VoxelType::u32},
    {"float", VoxelType::f32},        {"double", VoxelType::f64}};

struct Fields {
  std::map<std::string, std::string> of;
  std::string_view rest;  ///< after the blank line
};

std::string trimmed(std::string_view s) {
  const auto space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!s.empty() && space(s.front())) s.remove_prefix(1);
  while (!s.empty() && space(s.back())) s.remove_suffix(1);
  return std::string(s);
}

Fields read_header(std::string_view bytes, const std::string& name) {
  Fields f;
  std::size_t at = 0;
  for (;;) {
    const std::size_t end = bytes.find('\n', at);
    if (end == bytes.npos || end > kMostHeader) {
      // a detached header may end with its last line
      if (end == bytes.npos && at >= bytes.size() && !f.of.empty()) return f;
      refuse(name, "its header does not end", "copy the file again");
    }
    const std::string line = trimmed(bytes.substr(at, end - at));
    at = end + 1;
    if (line.empty()) break;
    if (line[0] == '#' || line.starts_with("NRRD") || line.find(":=") != line.npos) continue;
    const std::size_t colon = line.find(':');
    if (colon == line.npos)
      refuse(name, fmt::format("'{}' is no line of a header", line.substr(0, 40)), kAnew);
    f.of[line.substr(0, colon)] = trimmed(std::string_view(line).substr(colon + 1));
  }
  f.rest = bytes.substr(at);
  return f;
}

/// All numbers of a field; brackets and commas separate. Nothing where one is no finite number.
std::optional<std::vector<double>> numbers(std::string text) {
  for (char& c : text)
    if (c == '(' || c == ')' || c == ',') c = ' ';
  std::vector<double> out;
  const char* at = text.c_str();
  while (*at == ' ') ++at;
  while (*at) {
    char* end = nullptr;
    out.push_back(std::strtod(at, &end));
    if (end == at || !std::isfinite(out.back())) return std::nullopt;
    at = end;
    while (*at == ' ') ++at;
  }
  return out;
}

struct Reader {
  const std::string& name;
  Fields fields;

  [[nodiscard]] const std::string* find(const std::string& key) const {
    const auto at = fields.of.find(key);
    return at == fields.of.end() ? nullptr : &at->second;
  }
  [[nodiscard]] const std::string& must(const std::string& key) const {
    const std::string* value = find(key);
    if (!value) refuse(name, fmt::format("its header has no '{}'", key), kAnew);
    return *value;
  }
  [[nodiscard]] std::vector<double> list(const std::string& key, std::size_t n) const {
    const auto values = numbers(must(key));
    if (!values || values->size() != n)
      refuse(name, fmt::format("'{}' has not {} numbers", key, n), kAnew);
    return *values;
  }

  void set_grid(Volume& v) const {
    if (find("space directions")) {
      const auto d = list("space directions", 9);
      for (int a = 0; a < 3; ++a) v.step.col(a) = Vec3(d[3 * a], d[3 * a + 1], d[3 * a + 2]);
      if (find("space origin")) {
        const auto o = list("space origin", 3);
        v.origin = {o[0], o[1], o[2]};
      }
      // An odd number of axes away from right-anterior-superior is a left-handed frame.
      const std::string space = find("space") ? *find("space") : "";
      const bool mirrored =
          space == "left-anterior-superior" || space == "LAS" || space == "3D-left-handed";
      if (mirrored) {
        v.step.row(0) *= -1;
        v.origin[0] *= -1;
      }
      if (space.empty())
        v.warnings.push_back(name + " does not name its space: left and right may be swapped");
      return;
    }
    const auto edge = list("spacings", 3);
    for (int a = 0; a < 3; ++a) v.step(a, a) = edge[a];
    v.warnings.push_back(name + " does not say how its axes lie: left and right may be swapped");
  }
};

}  // namespace

Volume parse_nrrd(std::string_view bytes, const std::string& name,
                  const std::filesystem::path& folder) {
  if (!bytes.starts_with("NRRD000")) refuse(name, "is no NRRD file", "give a .nrrd or .nhdr");
  const Reader r{name, read_header(bytes, name)};
  if (r.list("dimension", 1)[0] != 3) refuse(name, "is not three-dimensional", kAnew);
  Volume v;
  v.format = "nrrd";
  const auto sizes = r.list("sizes", 3);
  std::array<std::int64_t, 3> size{};
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(sizes[a]) < 1e9)) refuse(name, "'sizes' are no sizes", kAnew);
    size[a] = static_cast<std::int64_t>(sizes[a]);
  }
  const std::size_t count = checked_count(size, name);
  for (int a = 0; a < 3; ++a) v.size[a] = static_cast<int>(size[a]);
  const auto type = kTypes.find(r.must("type"));
  if (type == kTypes.end())
    refuse(name, fmt::format("voxels of type '{}' are not read", r.must("type").substr(0, 40)),
           "convert it to short or float");
  r.set_grid(v);
  check_grid(v, name);

  std::string file;
  std::string_view data = r.fields.rest;
  const std::string* detached = r.find("data file") ? r.find("data file") : r.find("datafile");
  if (detached) {
    if (detached->find('%') != detached->npos || *detached == "LIST")
      refuse(name, "its voxels lie in many files", "write it anew as one .nrrd file");
    file = read_file(folder / *detached);
    data = file;
  }
  const std::string encoding = r.must("encoding");
  std::string inflated;
  if (encoding == "gzip" || encoding == "gz") {
    inflated = inflate_gzip(data, count * bytes_of(type->second), name);
    data = inflated;
  } else if (encoding != "raw") {
    refuse(name, fmt::format("encoding '{}' is not read", encoding.substr(0, 20)),
           "write it anew as raw or gzip");
  }
  const bool swap = r.find("endian") && *r.find("endian") == "big";
  v.value = to_floats(data, type->second, swap, count, 1, 0, name);
  return v;
}

}  // namespace palpate::image
