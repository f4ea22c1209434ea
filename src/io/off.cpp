// SPDX-License-Identifier: Apache-2.0
// OFF (Geomview): OFF, COFF, NOFF, STOFF and their combinations, as text. One element a line;
// what follows a vertex's three coordinates or a face's corners is passed over.
#include <fmt/format.h>

#include "io/mesh_builder.hpp"
#include "io/readers.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace {

class OffReader {
 public:
  explicit OffReader(const Source& source) : source_(source), text_(source.bytes), out_(source) {}

  ParsedMesh read() {
    std::string_view line = read_keyword();
    const std::int64_t vertices = read_count(line), faces = read_count(line);
    out_.announce(static_cast<std::uint64_t>(vertices), static_cast<std::uint64_t>(faces));
    // A vertex takes at least "0 0 0" and a line end, a face "3 0 0 0"; only the last may lack it.
    if (6 * vertices + 8 * faces > static_cast<std::int64_t>(text_.rest().size()) + 1)
      source_.fail(
          "header",
          fmt::format("{} vertices and {} faces do not fit into this file", vertices, faces),
          "the file is cut or its header damaged; export the mesh again");
    out_.mesh.points.reserve(static_cast<std::size_t>(vertices));
    out_.mesh.triangles.reserve(static_cast<std::size_t>(faces));
    for (std::int64_t v = 0; v < vertices; ++v) read_vertex(v);
    for (std::int64_t f = 0; f < faces; ++f) read_face(f);
    if (next_content(line))
      source_.fail(where("end", 0), "more lines than the header announces",
                   "the header's counts are wrong; export the mesh again");
    out_.finish("face");
    if (text_.ends_open() && last_bare_) out_.check_last_corner();
    ParsedMesh parsed;
    parsed.mesh = std::move(out_.mesh);
    return parsed;
  }

 private:
  [[nodiscard]] std::string where(std::string_view element, std::int64_t number) const {
    return element == "end" ? fmt::format("line {}", text_.line_number())
                            : fmt::format("{} {} (line {})", element, number, text_.line_number());
  }

  /// Next line that says something, without its comment.
  bool next_content(std::string_view& line) {
    while (text_.next_line(line)) {
      line = line.substr(0, line.find('#'));
      std::string_view probe = line;
      if (!next_token(probe).empty()) return true;
    }
    return false;
  }

  /// Returns what follows the keyword on its line (the counts may).
  std::string_view read_keyword() {
    std::string_view line;
    if (!next_content(line)) line = {};
    std::string_view word = next_token(line);
    if (word.size() < 3 || word.substr(word.size() - 3) != "OFF")
      source_.fail("line 1", fmt::format("{} instead of OFF", in_quotes(word)),
                   "write the keyword OFF on the first line, or export the mesh again");
    const std::string_view prefix = word.substr(0, word.size() - 3);
    if (prefix.find_first_not_of("STCN") != std::string_view::npos)
      source_.fail(
          "line 1",
          fmt::format("{} has vertices that are not three-dimensional points", in_quotes(word)),
          "export plain OFF");
    std::string_view probe = line;
    const std::string_view next = next_token(probe);
    if (next == "BINARY")
      source_.fail("line 1", "binary OFF is not read", "export it as text, or as PLY");
    return line;
  }

  std::int64_t read_count(std::string_view& line) {
    std::string_view token = next_token(line);
    if (token.empty()) {
      if (!next_content(line)) source_.fail("header", "no counts", "export the mesh again");
      token = next_token(line);
    }
    const auto count = parse_integer(token);
    if (!count || *count < 0 || *count > (std::int64_t{1} << 40))
      source_.fail("header", fmt::format("{} is not a count", in_quotes(token)),
                   "export the mesh again");
    return *count;
  }

  std::string_view element_line(std::string_view element, std::int64_t number) {
    std::string_view line;
    if (!next_content(line))
      source_.fail(fmt::format("{} {}", element, number), "missing: the file ends before it",
                   "the file is cut; export the mesh again");
    return line;
  }

  void read_vertex(std::int64_t number) {
    std::string_view line = element_line("vertex", number);
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view token = next_token(line);
      const auto value = parse_number(token);
      if (!value)
        source_.fail(where("vertex", number),
                     token.empty() ? fmt::format("{} coordinates", k)
                                   : fmt::format("{} is not a number", in_quotes(token)),
                     "export the mesh again; decimals need a point, not a comma");
      p[k] = *value;
    }
    out_.add_point(p, [&] { return where("vertex", number); });
  }

  void read_face(std::int64_t number) {
    std::string_view line = element_line("face", number);
    const auto corners = parse_integer(next_token(line));
    // Each corner takes a digit and a blank before it.
    if (!corners || *corners < 0 || *corners > static_cast<std::int64_t>(line.size() / 2))
      source_.fail(where("face", number), "its corners are missing", "export the mesh again");
    corners_.clear();
    for (std::int64_t k = 0; k < *corners; ++k) {
      const std::string_view token = next_token(line);
      const auto corner = parse_integer(token);
      if (!corner)
        source_.fail(where("face", number),
                     fmt::format("{} is not a vertex index", in_quotes(token)),
                     "export the mesh again");
      corners_.push_back(*corner);
    }
    last_bare_ = line.empty();
    out_.add_polygon(corners_, [&] { return where("face", number); });
  }

  const Source& source_;
  TextCursor text_;
  MeshBuilder out_;
  std::vector<std::int64_t> corners_;
  bool last_bare_ = false;  ///< nothing follows the last corner on its line
};

}  // namespace

ParsedMesh parse_off(const Source& source) {
  return OffReader(source).read();
}

}  // namespace palpate::io
