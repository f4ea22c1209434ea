// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, as far as meshes need it: JSON with limits, buffers, accessors with bounds checked.
// Materials, images, skins and animations are not looked at.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/source.hpp"

namespace palpate::io {

/// `count` elements of `components` scalars; every byte that element() reads is inside the buffer.
struct GltfAccessor {
  const char* data = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;  ///< [byte] from one element to the next
  int components = 1;
  ScalarType type = ScalarType::f32;
  bool normalized = false;

  /// Component of an element, scaled to [0, 1] or [-1, 1] where the accessor is normalized.
  [[nodiscard]] double value(std::size_t element, int component) const;
};

class GltfDocument {
 public:
  /// @throws InputError  cut, malformed, too deep, or with features that change geometry
  static GltfDocument from_glb(const Source& source);
  static GltfDocument from_gltf(const Source& source);

  [[nodiscard]] const nlohmann::json& root() const { return json_; }
  /// Entry of a top-level array, an object. @throws InputError
  [[nodiscard]] const nlohmann::json& entry(std::string_view array, std::uint64_t index) const;
  /// Non-negative integer member. @throws InputError where it is missing or something else
  [[nodiscard]] std::uint64_t integer(const nlohmann::json& object, std::string_view key,
                                      std::string_view where) const;
  /// The same, with a value for a missing member.
  [[nodiscard]] std::uint64_t integer(const nlohmann::json& object, std::string_view key,
                                      std::string_view where, std::uint64_t missing) const;
  [[nodiscard]] GltfAccessor accessor(std::uint64_t index) const;
  [[nodiscard]] const Source& source() const { return source_; }
  /// Contents of buffer files, in the order of the buffers; leaves the document without them.
  [[nodiscard]] std::vector<std::string> take_files() { return std::move(files_); }
  /// @throws InputError
  [[noreturn]] void fail(std::string_view where, std::string_view what) const;

 private:
  explicit GltfDocument(const Source& source) : source_(source) {}
  void parse_json(std::string_view text);
  void load_buffers(std::string_view binary_chunk);
  [[nodiscard]] std::string load_uri(const std::string& uri, const std::string& where);

  const Source& source_;
  nlohmann::json json_;
  std::vector<std::string> decoded_;  ///< data URIs
  std::vector<std::string> files_;
  std::vector<std::string_view> buffers_;
};

}  // namespace palpate::io
