// SPDX-License-Identifier: Apache-2.0
// Nothing half-written: a file appears under its name only when it is whole.
#pragma once
#include <filesystem>
#include <functional>
#include <ostream>
#include <string_view>

namespace palpate {

/// Writes to a temporary file beside `path`, flushes it to disk, then renames it.
/// @throws FileError  names the path and the system's reason; the temporary file is removed
void write_file(const std::filesystem::path& path, std::string_view bytes);
void write_file(const std::filesystem::path& path,
                const std::function<void(std::ostream&)>& writer);

/// Whole file as bytes. @throws InputError  names the path and the system's reason
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace palpate
