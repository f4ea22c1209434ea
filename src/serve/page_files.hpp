// SPDX-License-Identifier: GPL-3.0-or-later
// What the server may hand out: a fixed set of files, read when it starts.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace palpate::serve {

struct PageFile {
  std::string bytes;
  std::string_view type;  ///< for Content-Type
};

/// Path as a browser asks for it ("/assets/page.js") -> file. A request is an exact look-up here,
/// so no path, however written, reaches the disk.
using PageFiles = std::map<std::string, PageFile, std::less<>>;

/// Every regular file of `folder`, links left out; "/" is its index.html. An empty or missing
/// folder gives a single page that says how to build the viewer.
/// @throws InputError  a file that cannot be read, or more than 64 MB in all
[[nodiscard]] PageFiles load_page(const std::filesystem::path& folder);
/// Content-Type by the name's ending; "application/octet-stream" where unknown.
[[nodiscard]] std::string_view content_type(const std::filesystem::path& name);

}  // namespace palpate::serve
