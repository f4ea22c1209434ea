// SPDX-License-Identifier: Apache-2.0
// VTK's XML files (.vtp, .vtu): arrays inline as base64, little-endian, 64-bit lengths.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::io {

[[nodiscard]] std::string base64(std::string_view bytes);

/// Builds the text of one piece; sections are opened and closed by the caller.
class VtkXml {
 public:
  explicit VtkXml(std::string_view type);  ///< "PolyData" or "UnstructuredGrid"

  void line(std::string_view text) { (text_ += text) += '\n'; }
  template <typename T>
  void array(std::string_view name, std::span<const T> values, int components = 1) {
    raw_array(type_name(T{}), name, components,
              {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  template <typename T>
  void array(std::string_view name, const std::vector<T>& values, int components = 1) {
    array(name, std::span<const T>(values), components);
  }
  [[nodiscard]] std::string finish();

 private:
  static std::string_view type_name(double) { return "Float64"; }
  static std::string_view type_name(float) { return "Float32"; }
  static std::string_view type_name(std::int64_t) { return "Int64"; }
  static std::string_view type_name(std::uint8_t) { return "UInt8"; }
  void raw_array(std::string_view type, std::string_view name, int components,
                 std::string_view bytes);

  std::string text_;
  std::string type_;
};

}  // namespace palpate::io
