// SPDX-License-Identifier: Apache-2.0
// STL, binary and text. STL has no shared vertices: the mesh has three points per facet, in the
// file's order; joining them is the repair stage's work. Facet normals and attributes are not used.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "io/byte_reader.hpp"
#include "io/mesh_builder.hpp"
#include "io/readers.hpp"
#include "io/sniff.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace {

template <typename Where>
void add_facet(MeshBuilder& out, const Vec3 (&corner)[3], Where&& where) {
  const auto first = static_cast<std::int64_t>(out.mesh.points.size());
  for (const Vec3& p : corner) out.add_point(p, where);
  const std::int64_t corners[] = {first, first + 1, first + 2};
  out.add_polygon(corners, where);
}

ParsedMesh parse_binary(const Source& source) {
  constexpr std::size_t kHeader = 84, kFacet = 50;
  if (source.bytes.size() < kHeader)
    source.fail("header", "the file is shorter than an STL header", "export the mesh again");
  const auto count = load<std::uint32_t>(source.bytes.data() + 80);
  MeshBuilder out(source);
  out.announce(0, count);
  const std::size_t wanted = kHeader + kFacet * std::size_t{count};
  if (source.bytes.size() != wanted)
    source.fail(fmt::format("facet {}",
                            std::min<std::size_t>(count, (source.bytes.size() - kHeader) / kFacet)),
                fmt::format("the header announces {} facets ({} bytes) but the file has {} bytes",
                            count, wanted, source.bytes.size()),
                "the file is cut or damaged; export the mesh again");
  out.mesh.points.reserve(3 * std::size_t{count});
  out.mesh.triangles.reserve(count);
  for (std::size_t f = 0; f < count; ++f) {
    const char* at = source.bytes.data() + kHeader + f * kFacet + 12;  // past the normal
    Vec3 corner[3];
    for (Vec3& p : corner) {
      p = Vec3(load<float>(at), load<float>(at + 4), load<float>(at + 8));
      at += 12;
    }
    add_facet(out, corner, [&] { return fmt::format("facet {}", f); });
  }
  out.finish("facet");
  return {std::move(out.mesh), {}, {}, {}};
}

class TextStl {
 public:
  explicit TextStl(const Source& source) : source_(source), text_(source.bytes), out_(source) {}

  ParsedMesh read() {
    std::string_view line;
    bool inside = false;
    while (text_.next_line(line)) {
      const std::string_view word = next_token(line);
      if (word.empty()) continue;
      if (!inside && is(word, "solid"))
        inside = true;
      else if (inside && is(word, "endsolid"))
        inside = false;
      else if (inside && is(word, "facet"))
        read_facet();
      else
        source_.fail(where(), fmt::format("{} is not expected here", in_quotes(word)),
                     "export the mesh again");
    }
    if (inside)
      source_.fail(where(), "the file ends before 'endsolid'",
                   "the file is cut; export the mesh again");
    out_.finish("facet");
    return {std::move(out_.mesh), {}, {}, {}};
  }

 private:
  [[nodiscard]] std::string where() const { return fmt::format("line {}", text_.line_number()); }

  static bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char a, char b) {
      return std::tolower(static_cast<unsigned char>(a)) == b;
    });
  }
  void expect(std::string_view keyword) {
    const std::string_view word = text_.next_word();
    if (!is(word, keyword))
      source_.fail(where(), fmt::format("{} instead of '{}'", in_quotes(word), keyword),
                   "the file is cut or damaged; export the mesh again");
  }
  void read_facet() {
    expect("outer");
    expect("loop");
    Vec3 corner[3];
    for (Vec3& p : corner) {
      expect("vertex");
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = text_.next_word();
        const auto value = parse_number(word);
        if (!value)
          source_.fail(where(), fmt::format("{} is not a number", in_quotes(word)),
                       "export the mesh again; decimals need a point, not a comma");
        p[k] = *value;
      }
    }
    expect("endloop");
    expect("endfacet");
    add_facet(out_, corner, [this] { return where(); });
  }

  const Source& source_;
  TextCursor text_;
  MeshBuilder out_;
};

}  // namespace

ParsedMesh parse_stl(const Source& source) {
  return is_text_stl(source.bytes) ? TextStl(source).read() : parse_binary(source);
}

}  // namespace palpate::io
