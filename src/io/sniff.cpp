// SPDX-License-Identifier: Apache-2.0
#include "io/sniff.hpp"

#include <algorithm>
#include <array>

#include "io/byte_reader.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace {

struct Magic {
  std::string_view bytes;
  std::string_view name;
};
constexpr Magic kForeign[] = {{"PK\x03\x04", "a ZIP archive (3MF?)"},
                              {"\x1f\x8b", "a gzip archive"},
                              {"\x89PNG", "a PNG picture"},
                              {"\xff\xd8\xff", "a JPEG picture"},
                              {"%PDF", "a PDF document"},
                              {"#VRML", "VRML"},
                              {"# vtk DataFile", "a legacy VTK file"},
                              {"<?xml", "XML (VTK, X3D or COLLADA?)"},
                              {"<VTKFile", "a VTK XML file"},
                              {"<!DOCTYPE html", "a web page"},
                              {"<html", "a web page"},
                              {"Kaydara FBX", "FBX"},
                              {"BLENDER", "a Blender file"},
                              {"\x7f"
                               "ELF",
                               "a program"},
                              {"\xff\xfe", "UTF-16 text"},
                              {"\xfe\xff", "UTF-16 text"},
                              {"$MeshFormat", "a Gmsh mesh"}};

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= 84 && (bytes.size() - 84) % 50 == 0 &&
         load<std::uint32_t>(bytes.data() + 80) == (bytes.size() - 84) / 50;
}

bool is_text(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u < 32 && !is_blank(c) && !is_line_end(c);
  });
}

bool is_obj(std::string_view head) {
  TextCursor text(head);
  std::string_view line;
  constexpr std::array<std::string_view, 8> kWords = {"v", "vt", "vn",     "f",
                                                      "o", "g",  "mtllib", "usemtl"};
  while (text.next_line(line)) {
    const std::string_view word = next_token(line);
    if (word.empty() || word.front() == '#') continue;
    return std::find(kWords.begin(), kWords.end(), word) != kWords.end() &&
           !next_token(line).empty();
  }
  return false;
}

bool is_off(std::string_view head) {
  TextCursor text(head);
  std::string_view line;
  while (text.next_line(line)) {
    const std::string_view word = next_token(line);
    if (word.empty() || word.front() == '#') continue;
    return word.size() >= 3 && word.size() <= 8 && word.substr(word.size() - 3) == "OFF";
  }
  return false;
}

}  // namespace

bool is_text_stl(std::string_view bytes) {
  std::string_view head = bytes.substr(0, 2000);
  const std::string_view first = next_token(head);
  if (first.size() < 5 || is_binary_stl(bytes)) return false;
  const std::string_view keyword = first.substr(0, 5);
  return (keyword == "solid" || keyword == "SOLID" || keyword == "Solid") &&
         is_text(bytes.substr(0, 2000));
}

std::string_view looks_like(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 4000);
  if (head.starts_with("glTF")) return "glb";
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return "ply";
  if (is_binary_stl(bytes) || is_text_stl(bytes)) return "stl";
  for (const Magic& m : kForeign)
    if (head.starts_with(m.bytes)) return m.name;
  if (bytes.size() > 132 && bytes.substr(128, 4) == "DICM") return "a DICOM image";
  if (!is_text(head)) return "unknown binary data";
  std::string_view probe = head;
  while (!probe.empty() && (is_blank(probe.front()) || is_line_end(probe.front())))
    probe.remove_prefix(1);
  if (probe.starts_with('{')) return bytes.find("\"asset\"") < bytes.size() ? "gltf" : "JSON";
  if (is_off(head)) return "off";
  if (is_obj(head)) return "obj";
  return "text";
}

}  // namespace palpate::io
