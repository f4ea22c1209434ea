// SPDX-License-Identifier: Apache-2.0
// A file being read: its name for messages, its bytes for the parser, and where they ended.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate::io {

/// Bytes of one input file. The readers are pure functions of it, so that tests and the fuzzer need
/// no file system.
struct Source {
  std::string name;  ///< as the user wrote it
  std::string_view bytes;
  std::filesystem::path folder;  ///< of files named inside this one (glTF buffers)

  /// One line: "<name>: <where>: <what>; <remedy>". `where` may be empty.
  /// @throws InputError always
  [[noreturn]] void fail(std::string_view where, std::string_view what,
                         std::string_view remedy) const;
};

/// Whole regular file in memory, read at disk speed.
/// @throws InputError  missing, unreadable, not a regular file, empty or larger than 16 GiB
[[nodiscard]] std::string load_bytes(const std::filesystem::path& path);

/// Makes text from a file safe for a one-line message: printable ASCII, at most 40 characters.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace palpate::io
