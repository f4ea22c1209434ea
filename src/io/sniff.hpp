// SPDX-License-Identifier: Apache-2.0
// What a file is, by its content.
#pragma once
#include <string_view>

namespace palpate::io {

/// Short name of the format that the bytes look like: "obj", "ply", "stl", "off", "gltf" or "glb"
/// for what read_scan reads, another description ("a ZIP archive", "text") otherwise.
[[nodiscard]] std::string_view looks_like(std::string_view bytes);

/// STL as text; a binary STL may begin with "solid" too, but its size follows from its count.
[[nodiscard]] bool is_text_stl(std::string_view bytes);

}  // namespace palpate::io
