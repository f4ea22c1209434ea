// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_xml.hpp"

#include <fmt/format.h>

namespace palpate::io {

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out.push_back(k <= n ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
  }
  return out;
}

VtkXml::VtkXml(std::string_view type) : type_(type) {
  line("<?xml version=\"1.0\"?>");
  line(
      fmt::format("<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
                  "header_type=\"UInt64\">",
                  type));
  line(fmt::format("<{}>", type));
}

void VtkXml::raw_array(std::string_view type, std::string_view name, int components,
                       std::string_view bytes) {
  // The array's length in bytes and its values are one base64 text.
  const std::uint64_t size = bytes.size();
  std::string block(reinterpret_cast<const char*>(&size), sizeof(size));
  block += bytes;
  text_ += fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n", type,
      name, components);
  text_ += base64(block);
  text_ += "\n</DataArray>\n";
}

std::string VtkXml::finish() {
  line(fmt::format("</{}>", type_));
  line("</VTKFile>");
  return std::move(text_);
}

}  // namespace palpate::io
