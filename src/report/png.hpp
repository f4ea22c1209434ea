// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures as bytes and as text.
#pragma once
#include <string>
#include <string_view>

#include "report/render.hpp"

namespace palpate::report {

/// PNG file with alpha; the same image gives the same bytes. @throws InputError for an empty image
[[nodiscard]] std::string encode_png(const Image& image);
/// RFC 4648, with padding, without line breaks.
[[nodiscard]] std::string base64(std::string_view bytes);
/// "data:image/png;base64,..." for a page that carries its pictures itself.
[[nodiscard]] std::string data_url(const Image& image);

}  // namespace palpate::report
