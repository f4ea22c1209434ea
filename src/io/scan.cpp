// SPDX-License-Identifier: Apache-2.0
#include "io/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "io/readers.hpp"
#include "io/sha256.hpp"
#include "io/sniff.hpp"

namespace palpate::io {
namespace {

struct Format {
  std::string_view name;
  ParsedMesh (*parse)(const Source&);
};
constexpr std::array<Format, 6> kFormats = {
    Format{"obj", parse_obj},   Format{"ply", [](const Source& s) { return parse_ply(s); }},
    Format{"stl", parse_stl},   Format{"off", parse_off},
    Format{"gltf", parse_gltf}, Format{"glb", parse_glb}};

const Format* find_format(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const Format& f) { return f.name == name; });
  return found == kFormats.end() ? nullptr : found;
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// A file whose content is plainly something else is refused before it is parsed.
void check_content(const Source& source, std::string_view extension) {
  const std::string_view looks = looks_like(source.bytes);
  if (looks == extension) return;
  if (const Format* other = find_format(looks))
    source.fail("", fmt::format("the content is {}, not {}", other->name, extension),
                fmt::format("rename the file to .{}", other->name));
  // Damaged or cut files of the right kind are left to their reader, which knows the place.
  if (looks == "text" && (extension == "obj" || extension == "off" || extension == "ply")) return;
  if (looks == "unknown binary data" && extension != "gltf") return;
  if (looks == "JSON" && extension == "gltf") return;
  source.fail("", fmt::format("the content looks like {}, not {}", looks, extension),
              "name a mesh file (obj, ply, stl, off, gltf or glb)");
}

}  // namespace

Scan read_scan(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  const std::string bytes = load_bytes(path);
  Source source{path.string(), bytes, path.parent_path()};
  const Format* format = find_format(extension);
  if (!format)
    source.fail("",
                fmt::format("the extension {} names no mesh format that is read; the content "
                            "looks like {}",
                            in_quotes("." + extension), looks_like(bytes)),
                "export obj, ply, stl, off, gltf or glb");
  if (bytes.starts_with("\xef\xbb\xbf")) source.bytes.remove_prefix(3);  // a text editor's mark
  check_content(source, extension);
  ParsedMesh parsed = format->parse(source);
  Sha256 hash;
  hash.add(bytes);
  for (const std::string& other : parsed.external) hash.add(other);
  return {std::move(parsed.mesh), std::string(format->name), parsed.unit_mm, hash.hex(),
          std::move(parsed.warnings)};
}

}  // namespace palpate::io
