// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v and f of all objects and groups; everything else is passed over.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/mesh_builder.hpp"
#include "io/readers.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace {

// Statements that carry no polygon mesh. Anything else is not OBJ (or a cut word).
constexpr std::array<std::string_view, 42> kPassedOver = {
    "vt",        "vn",    "vp",     "g",      "o",    "s",     "mtllib",   "usemtl",   "l",
    "p",         "mg",    "maplib", "usemap", "lod",  "bevel", "c_interp", "d_interp", "shadow_obj",
    "trace_obj", "ctech", "stech",  "cstype", "deg",  "bmat",  "step",     "curv",     "curv2",
    "surf",      "parm",  "trim",   "hole",   "scrv", "sp",    "end",      "con",      "call",
    "csh",       "res",   "cdc",    "cdp",    "bzp",  "bsp"};

class ObjReader {
 public:
  explicit ObjReader(const Source& source) : source_(source), text_(source.bytes), out_(source) {}

  ParsedMesh read() {
    std::string_view line;
    while (next_statement(line)) {
      const std::string_view keyword = next_token(line);
      if (keyword.empty() || keyword.front() == '#') continue;
      last_is_vertex_ = keyword == "v";
      if (keyword == "v")
        read_vertex(line);
      else if (keyword == "f" || keyword == "fo")
        read_face(line);
      else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end())
        source_.fail(where(), fmt::format("{} is not an OBJ statement", in_quotes(keyword)),
                     "remove the line, or export the mesh again if the file was cut");
      last_is_face_ = keyword == "f" || keyword == "fo";
    }
    return finish();
  }

 private:
  [[nodiscard]] std::string where() const { return fmt::format("line {}", text_.line_number()); }

  /// A line, with its continuations (a backslash at the end) joined to it.
  bool next_statement(std::string_view& line) {
    if (!text_.next_line(line)) return false;
    if (line.empty() || line.back() != '\\') return true;
    joined_.clear();
    do {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      if (!text_.next_line(line))
        source_.fail(where(), "the last line ends in a backslash", "export the mesh again");
    } while (!line.empty() && line.back() == '\\');
    joined_.append(line);
    line = joined_;
    return true;
  }

  void read_vertex(std::string_view line) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view token = next_token(line);
      const auto value = parse_number(token);
      if (!value)
        source_.fail(where(),
                     token.empty() ? fmt::format("a vertex with {} coordinates", k)
                                   : fmt::format("{} is not a number", in_quotes(token)),
                     "export the mesh again; decimals need a point, not a comma");
      p[k] = *value;
    }
    vertex_cut_ = line.empty();
    out_.add_point(p, [this] { return where(); });
  }

  void read_face(std::string_view line) {
    corners_.clear();
    int form = -1;
    for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
      if (token.front() == '#') break;
      const int this_form = read_corner(token);
      if (form >= 0 && this_form != form)
        source_.fail(where(), "the corners of a face have different forms",
                     "export the mesh again; is the file cut?");
      form = this_form;
    }
    out_.add_polygon(corners_, [this] { return where(); });
  }

  /// "v", "v/t", "v//n" or "v/t/n"; returns which of the four.
  int read_corner(std::string_view token) {
    const std::string_view whole = token;
    std::array<std::string_view, 3> part;
    int parts = 0;
    for (;; ++parts) {
      const std::size_t slash = token.find('/');
      if (parts < 3) part[parts] = token.substr(0, slash);
      if (slash == std::string_view::npos) break;
      token.remove_prefix(slash + 1);
    }
    const auto vertex = parse_integer(part[0]);
    bool good = parts < 3 && vertex && *vertex != 0;
    for (int k = 1; good && k <= parts; ++k)
      good = (part[k].empty() && k == 1 && parts == 2) || parse_integer(part[k]).has_value();
    if (!good)
      source_.fail(where(), fmt::format("{} is not a face corner", in_quotes(whole)),
                   "corners are v, v/t, v//n or v/t/n with indices from 1; export the mesh again");
    relative_ = *vertex < 0;
    const auto count = static_cast<std::int64_t>(out_.mesh.points.size());
    if (*vertex < -count)
      source_.fail(where(), fmt::format("corner {} reaches before the first vertex", *vertex),
                   "export the mesh again");
    corners_.push_back(*vertex > 0 ? *vertex - 1 : count + *vertex);
    return parts == 2 && part[1].empty() ? 3 : parts;
  }

  ParsedMesh finish() {
    out_.finish("face");
    const std::size_t unused = out_.unused_points();
    const bool open = text_.ends_open();
    // A file cut at a line end is told only by what is missing: faces of vertices that are there.
    if ((open && unused > 0 && last_is_face_) || 2 * unused > out_.mesh.points.size())
      source_.fail("",
                   fmt::format("{} of {} vertices are in no face; the file seems to be cut", unused,
                               out_.mesh.points.size()),
                   "export the mesh again, or remove the unused vertices");
    if (open && last_is_vertex_ && vertex_cut_)
      source_.fail(where(), "ends inside a vertex", "export the mesh again");
    if (open && last_is_face_) out_.check_last_corner(relative_);
    ParsedMesh parsed;
    if (unused > 0)
      parsed.warnings.push_back(
          fmt::format("{} vertices are in no face; if the file was cut, export it again", unused));
    parsed.mesh = std::move(out_.mesh);
    return parsed;
  }

  const Source& source_;
  TextCursor text_;
  MeshBuilder out_;
  std::string joined_;
  std::vector<std::int64_t> corners_;
  bool relative_ = false;
  bool vertex_cut_ = false;
  bool last_is_face_ = false;
  bool last_is_vertex_ = false;
};

}  // namespace

ParsedMesh parse_obj(const Source& source) {
  return ObjReader(source).read();
}

}  // namespace palpate::io
