// SPDX-License-Identifier: Apache-2.0
// head.glb: glTF 2.0 with the user's vertices, colours, curves and provenance (docs/formats.md).
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/touchable_head.hpp"

namespace palpate::io {

inline constexpr const char* kHeadExtension = "PALPATE_touchable_head";
inline constexpr int kHeadFormatVersion = 1;

/// Numbers are stored as 32-bit floats: a vertex that the scan gives with more digits is rounded to
/// the nearest one (relative 6e-8). Equal heads give equal bytes.
/// @throws InputError  the head is inconsistent (sizes, a curve that does not ascend): names the
///         first bad vertex
/// @throws FileError  cannot write; nothing is left under the name
void write_head(const std::filesystem::path& path, const TouchableHead& head);
/// @throws InputError  not a head.glb, truncated, or inconsistent: one line with the element
[[nodiscard]] TouchableHead read_head(const std::filesystem::path& path);

/// The file's bytes, and the way back; `name` stands for the file in messages.
[[nodiscard]] std::string head_bytes(const TouchableHead& head);
[[nodiscard]] TouchableHead parse_head(std::string_view bytes, const std::string& name);
/// The bytes that a head has with an empty `run` object: equal for equal results, whatever the
/// thread count and the timings were. @throws InputError where `bytes` is not a GLB
[[nodiscard]] std::string head_bytes_without_run(std::string_view bytes, const std::string& name);

}  // namespace palpate::io
