// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: which elements follow, with which properties.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/source.hpp"

namespace palpate::io {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::f32;  ///< of the value, or of a list's items
  bool is_list = false;
  ScalarType count_type = ScalarType::u8;  ///< of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Index of the property, or -1.
  [[nodiscard]] int find(std::string_view property) const;
  /// Fewest bytes that one such element takes in the body.
  [[nodiscard]] std::uint64_t smallest_bytes(bool ascii) const;
};

struct PlyHeader {
  enum class Format { ascii, little, big } format = Format::ascii;
  std::vector<PlyElement> elements;
  std::size_t body = 0;   ///< offset of the first byte after the header
  std::size_t lines = 0;  ///< lines of the header
};

/// @throws InputError  names the line
[[nodiscard]] PlyHeader parse_ply_header(const Source& source);

}  // namespace palpate::io
