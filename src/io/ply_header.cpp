// SPDX-License-Identifier: Apache-2.0
#include "io/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "io/text_cursor.hpp"

namespace palpate::io {

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return static_cast<int>(i);
  return -1;
}

std::uint64_t PlyElement::smallest_bytes(bool ascii) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& p : properties)
    bytes += ascii ? 2 : byte_size(p.is_list ? p.count_type : p.type);  // a digit and a blank
  return bytes;
}

namespace {

std::optional<ScalarType> scalar_type(std::string_view word) {
  struct Entry {
    std::string_view name;
    ScalarType type;
  };
  static constexpr Entry kTypes[] = {
      {"char", ScalarType::i8},    {"int8", ScalarType::i8},     {"uchar", ScalarType::u8},
      {"uint8", ScalarType::u8},   {"short", ScalarType::i16},   {"int16", ScalarType::i16},
      {"ushort", ScalarType::u16}, {"uint16", ScalarType::u16},  {"int", ScalarType::i32},
      {"int32", ScalarType::i32},  {"uint", ScalarType::u32},    {"uint32", ScalarType::u32},
      {"float", ScalarType::f32},  {"float32", ScalarType::f32}, {"double", ScalarType::f64},
      {"float64", ScalarType::f64}};
  for (const Entry& e : kTypes)
    if (e.name == word) return e.type;
  return std::nullopt;
}

constexpr std::size_t kMaxNames = 1000;  // elements or properties; real files have below 100

class HeaderReader {
 public:
  explicit HeaderReader(const Source& source) : source_(source), text_(source.bytes) {}

  PlyHeader read() {
    std::string_view line;
    if (!text_.next_line(line) || next_token(line) != "ply")
      fail("the file does not begin with 'ply'");
    while (text_.next_line(line)) {
      const std::string_view keyword = next_token(line);
      if (keyword == "end_header") return finish();
      if (keyword == "format")
        read_format(line);
      else if (keyword == "element")
        read_element(line);
      else if (keyword == "property")
        read_property(line);
      else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info")
        fail(fmt::format("{} is not a PLY header word", in_quotes(keyword)));
    }
    fail("the header has no 'end_header'");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    source_.fail(fmt::format("header line {}", text_.line_number()), what,
                 "the file is cut or damaged; export the mesh again");
  }

  PlyHeader finish() {
    if (!has_format_) fail("no 'format' line");
    if (text_.rest().empty() && text_.ends_open()) fail("nothing follows 'end_header'");
    header_.body = source_.bytes.size() - text_.rest().size();
    header_.lines = text_.line_number();
    return std::move(header_);
  }

  void read_format(std::string_view line) {
    const std::string_view format = next_token(line), version = next_token(line);
    if (has_format_) fail("a second 'format' line");
    if (format == "ascii")
      header_.format = PlyHeader::Format::ascii;
    else if (format == "binary_little_endian")
      header_.format = PlyHeader::Format::little;
    else if (format == "binary_big_endian")
      header_.format = PlyHeader::Format::big;
    else
      fail(fmt::format("{} is not a PLY format", in_quotes(format)));
    if (version != "1.0") fail(fmt::format("version {} is not 1.0", in_quotes(version)));
    has_format_ = true;
  }

  void read_element(std::string_view line) {
    const std::string_view name = next_token(line), count = next_token(line);
    const auto value = parse_integer(count);
    if (name.empty() || !value || *value < 0)
      fail(fmt::format("element {} has the count {}", in_quotes(name), in_quotes(count)));
    if (header_.elements.size() >= kMaxNames) fail("more than 1000 elements");
    header_.elements.push_back({std::string(name), static_cast<std::uint64_t>(*value), {}});
  }

  void read_property(std::string_view line) {
    if (header_.elements.empty()) fail("a property before the first element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view type = next_token(line);
    property.is_list = type == "list";
    if (property.is_list) {
      const std::string_view count = next_token(line);
      const auto known = scalar_type(count);
      if (!known || *known == ScalarType::f32 || *known == ScalarType::f64)
        fail(fmt::format("{} cannot count a list", in_quotes(count)));
      property.count_type = *known;
      type = next_token(line);
    }
    const auto known = scalar_type(type);
    if (!known) fail(fmt::format("{} is not a PLY type", in_quotes(type)));
    property.type = *known;
    property.name = std::string(next_token(line));
    if (property.name.empty()) fail("a property without a name");
    if (element.properties.size() >= kMaxNames) fail("more than 1000 properties");
    element.properties.push_back(std::move(property));
  }

  const Source& source_;
  TextCursor text_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace

PlyHeader parse_ply_header(const Source& source) {
  return HeaderReader(source).read();
}

}  // namespace palpate::io
