// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/page_files.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <iterator>

#include "core/error.hpp"

namespace palpate::serve {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostBytes = 64U << 20;  // a built page has about 1 MB

constexpr std::string_view kNoPage =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Palpate</title>"
    "<h1>The viewer is not built</h1><p>It needs Node.js and npm (Debian: <code>apt-get install "
    "nodejs npm</code>) and, once, a network to fetch its packages. Then run <code>make "
    "build</code> and start this command again.</p><p>The touch loop runs all the same; the head "
    "is "
    "at <a href=\"head.glb\">head.glb</a>.</p></html>\n";

}  // namespace

std::string_view content_type(const fs::path& name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".glb", "model/gltf-binary"},
  }};
  const std::string ending = name.extension().string();
  for (const auto& [known, type] : kTypes)
    if (ending == known) return type;
  return "application/octet-stream";
}

PageFiles load_page(const fs::path& folder) {
  PageFiles files;
  std::error_code error;
  std::size_t total = 0;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (it->is_symlink() || !it->is_regular_file()) continue;
    std::ifstream in(it->path(), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) throw InputError(fmt::format("{}: cannot be read", it->path().string()));
    total += bytes.size();
    if (total > kMostBytes)
      throw InputError(fmt::format("{}: more than {} MB; this is not a built page", folder.string(),
                                   kMostBytes >> 20));
    const std::string name =
        fmt::format("/{}", it->path().lexically_relative(folder).generic_string());
    files[name] = {std::move(bytes), content_type(name)};
  }
  if (const auto index = files.find("/index.html"); index != files.end())
    files["/"] = index->second;
  else
    files["/"] = {std::string(kNoPage), content_type("index.html")};
  return files;
}

}  // namespace palpate::serve
