// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/png.hpp"

// Static: another library of the program may carry its own copy of these functions.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <algorithm>

#include "core/error.hpp"

namespace palpate::report {

std::string encode_png(const Image& image) {
  const std::size_t size = static_cast<std::size_t>(image.width) * image.height * 4;
  if (size == 0 || image.rgba.size() != size) throw InputError("picture: nothing to encode");
  std::string out;
  const auto append = [](void* context, void* data, int bytes) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), bytes);
  };
  if (!stbi_write_png_to_func(append, &out, image.width, image.height, 4, image.rgba.data(),
                              image.width * 4))
    throw InputError("picture: not enough memory to encode it");
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= left ? kLetters[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string data_url(const Image& image) {
  return "data:image/png;base64," + base64(encode_png(image));
}

}  // namespace palpate::report
