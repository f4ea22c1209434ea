// SPDX-License-Identifier: Apache-2.0
// head.glb: glTF 2.0 with the user's vertices, colours, curves and provenance (docs/formats.md).
#pragma once
#include <filesystem>

#include "core/touchable_head.hpp"

namespace palpate::io {

/// @throws FileError  cannot write; nothing is left under the name
void write_head(const std::filesystem::path& path, const TouchableHead& head);
/// @throws InputError  not a head.glb, truncated, or inconsistent: one line with the element
[[nodiscard]] TouchableHead read_head(const std::filesystem::path& path);

}  // namespace palpate::io
