// SPDX-License-Identifier: Apache-2.0
// PLY: ascii and both binary orders. Vertices may be of any scalar type; other elements and
// properties are passed over.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/mesh_builder.hpp"
#include "io/ply_header.hpp"
#include "io/readers.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace {

/// Values of the body, one after the other; knows how many bytes the rest can still hold.
class BinaryBody {
 public:
  BinaryBody(const Source& source, const PlyHeader& header)
      : at_(source.bytes.data() + header.body),
        end_(source.bytes.data() + source.bytes.size()),
        big_(header.format == PlyHeader::Format::big) {}
  bool next(ScalarType type, double& value) {
    const std::size_t size = byte_size(type);
    if (left() < size) return false;
    value = load_scalar(at_, type, big_);
    at_ += size;
    return true;
  }
  bool skip(ScalarType type, std::uint64_t count) {
    if (count > left() / byte_size(type)) return false;
    at_ += count * byte_size(type);
    return true;
  }
  [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  [[nodiscard]] static std::size_t item_bytes(ScalarType type) { return byte_size(type); }
  [[nodiscard]] std::string place() const { return {}; }
  [[nodiscard]] std::string_view bad_word() const { return {}; }
  /// Some writers pad the end; anything but padding is data that the header does not announce.
  [[nodiscard]] bool at_end() const {
    return std::all_of(at_, end_, [](char c) { return c == 0 || c == '\n' || c == '\r'; });
  }
  [[nodiscard]] bool ends_in_word() const { return false; }

 private:
  const char* at_;
  const char* end_;
  bool big_;
};

class TextBody {
 public:
  TextBody(const Source& source, const PlyHeader& header)
      : text_(source.bytes.substr(header.body)), header_lines_(header.lines) {}
  bool next(ScalarType type, double& value) {
    word_ = text_.next_word();
    const auto number = parse_number(word_);
    if (!number) return false;
    const bool real = type == ScalarType::f32 || type == ScalarType::f64;
    value = *number;
    return real || value == std::floor(value);
  }
  bool skip(ScalarType type, std::uint64_t count) {
    double ignored;
    for (std::uint64_t i = 0; i < count; ++i)
      if (!next(type, ignored)) return false;
    return true;
  }
  [[nodiscard]] std::size_t left() const { return text_.rest().size(); }
  [[nodiscard]] static std::size_t item_bytes(ScalarType) { return 2; }  // a blank and a digit
  [[nodiscard]] std::string place() const {
    return fmt::format(" (line {})", header_lines_ + text_.line_number());
  }
  [[nodiscard]] std::string_view bad_word() const { return word_; }
  [[nodiscard]] bool at_end() const {
    TextCursor probe = text_;
    return probe.next_word().empty();
  }
  [[nodiscard]] bool ends_in_word() const { return text_.rest().empty() && text_.ends_open(); }

 private:
  TextCursor text_;
  std::size_t header_lines_;
  std::string_view word_;
};

template <typename Body>
class PlyReader {
 public:
  PlyReader(const Source& source, const PlyHeader& header, const std::string& property)
      : source_(source), header_(header), body_(source, header), out_(source), wanted_(property) {}

  ParsedMesh read() {
    check_counts();
    for (const PlyElement& element : header_.elements) {
      last_ = {};
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        for (std::uint64_t i = 0; i < element.count; ++i)
          for (const PlyProperty& p : element.properties) skip(element, i, p);
    }
    if (!body_.at_end())
      source_.fail("end", "the file goes on after the last element that its header announces",
                   "the header's counts are wrong or the data is damaged; export the mesh again");
    out_.finish("face");
    check_last_word();
    return {std::move(out_.mesh), {}, std::move(values_), {}};
  }

 private:
  static bool ascii() { return std::is_same_v<Body, TextBody>; }

  void check_counts() const {
    bool vertices = false, faces = false;
    for (const PlyElement& e : header_.elements) {
      if (e.name != "vertex" && e.name != "face") continue;
      bool& seen = e.name == "vertex" ? vertices : faces;
      if (seen) source_.fail("header", fmt::format("two elements '{}'", e.name), "export again");
      seen = true;
      out_.announce(e.name == "vertex" ? e.count : 0, e.name == "face" ? e.count : 0);
    }
    // The last word of a text needs no blank behind it.
    std::uint64_t left = body_.left() + (ascii() ? 1 : 0);
    for (const PlyElement& e : header_.elements) {
      const std::uint64_t each = e.smallest_bytes(ascii());
      if (each > 0 ? e.count > left / each : e.count > kMaxVertices)
        source_.fail(
            "header",
            fmt::format("{} elements {} do not fit into this file", e.count, in_quotes(e.name)),
            "the file is cut or its header damaged; export the mesh again");
      left -= each * e.count;
    }
    if (!vertices) source_.fail("header", "no element 'vertex'", "export a triangle mesh");
    if (!faces)
      source_.fail("header", "no element 'face'",
                   "export triangles, not a point cloud or triangle strips");
  }

  [[nodiscard]] std::string where(const PlyElement& e, std::uint64_t i) const {
    return fmt::format("{} {}{}",
                       e.name == "vertex" || e.name == "face" ? e.name : in_quotes(e.name), i,
                       body_.place());
  }
  [[noreturn]] void fail(const PlyElement& e, std::uint64_t i, const PlyProperty& p) const {
    const std::string_view word = body_.bad_word();
    source_.fail(
        where(e, i),
        word.empty()
            ? fmt::format("the file ends before its property {}", in_quotes(p.name))
            : fmt::format("{} is not a value of property {}", in_quotes(word), in_quotes(p.name)),
        "the file is cut or damaged; export the mesh again");
  }
  double value(const PlyElement& e, std::uint64_t i, const PlyProperty& p, ScalarType type) {
    double v = 0;
    if (!body_.next(type, v)) fail(e, i, p);
    return v;
  }
  std::uint64_t list_length(const PlyElement& e, std::uint64_t i, const PlyProperty& p) {
    const double n = value(e, i, p, p.count_type);
    if (!(n >= 0) || n > static_cast<double>(body_.left() / body_.item_bytes(p.type)))
      source_.fail(where(e, i), fmt::format("property {} has {} items", in_quotes(p.name), n),
                   "the file is cut or damaged; export the mesh again");
    return static_cast<std::uint64_t>(n);
  }
  void skip(const PlyElement& e, std::uint64_t i, const PlyProperty& p) {
    if (!body_.skip(p.type, p.is_list ? list_length(e, i, p) : 1)) fail(e, i, p);
  }

  void read_vertices(const PlyElement& e) {
    const int x = e.find("x"), y = e.find("y"), z = e.find("z");
    const int extra = wanted_.empty() ? -1 : e.find(wanted_);
    for (const int column : {x, y, z, extra})
      if ((column < 0 && (column != extra || !wanted_.empty())) ||
          (column >= 0 && e.properties[column].is_list))
        source_.fail("header",
                     "vertices lack one of the properties x, y, z" +
                         (wanted_.empty() ? "" : " or " + wanted_),
                     "export the mesh again");
    const auto columns = static_cast<int>(e.properties.size());
    out_.mesh.points.reserve(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i) {
      Vec3 point;
      for (int c = 0; c < columns; ++c) {
        const PlyProperty& p = e.properties[c];
        if (c == x || c == y || c == z)
          point[c == x ? 0 : c == y ? 1 : 2] = value(e, i, p, p.type);
        else if (c == extra)
          values_.push_back(value(e, i, p, p.type));
        else
          skip(e, i, p);
      }
      out_.add_point(point, [&] { return where(e, i); });
    }
    const PlyProperty& last = e.properties.back();
    last_ = {&last == &e.properties[x] || &last == &e.properties[y] || &last == &e.properties[z] ||
                 (extra >= 0 && &last == &e.properties[extra]),
             false};
  }

  void read_faces(const PlyElement& e) {
    int corners_at = e.find("vertex_indices");
    if (corners_at < 0) corners_at = e.find("vertex_index");
    if (e.count > 0 && (corners_at < 0 || !e.properties[corners_at].is_list))
      source_.fail("header", "faces have no list 'vertex_indices'", "export the mesh again");
    out_.mesh.triangles.reserve(e.count);
    const auto columns = static_cast<int>(e.properties.size());
    for (std::uint64_t i = 0; i < e.count; ++i)
      for (int c = 0; c < columns; ++c) {
        const PlyProperty& p = e.properties[c];
        if (c == corners_at)
          read_corners(e, i, p);
        else
          skip(e, i, p);
      }
    last_ = {false, corners_at == columns - 1};
  }

  void read_corners(const PlyElement& e, std::uint64_t i, const PlyProperty& p) {
    const std::uint64_t n = list_length(e, i, p);
    corners_.clear();
    for (std::uint64_t k = 0; k < n; ++k) {
      const double index = value(e, i, p, p.type);
      if (!(index >= 0) || index >= static_cast<double>(kMaxVertices) || index != std::floor(index))
        source_.fail(where(e, i), fmt::format("{} is not a vertex index", index),
                     "export the mesh again");
      corners_.push_back(static_cast<std::int64_t>(index));
    }
    out_.add_polygon(corners_, [&] { return where(e, i); });
  }

  /// A text may be cut inside its last number; harmless where that number is not used.
  void check_last_word() const {
    if (!body_.ends_in_word()) return;
    if (last_.coordinate)
      source_.fail("last line", "has no line end, so its last number may be cut",
                   "export the mesh again, or end the last line if the file is whole");
    if (last_.corner) out_.check_last_corner();
  }

  struct LastWord {
    bool coordinate = false;
    bool corner = false;
  };

  const Source& source_;
  const PlyHeader& header_;
  Body body_;
  MeshBuilder out_;
  const std::string& wanted_;
  std::vector<double> values_;
  std::vector<std::int64_t> corners_;
  LastWord last_;
};

}  // namespace

ParsedMesh parse_ply(const Source& source, const std::string& property) {
  const PlyHeader header = parse_ply_header(source);
  if (header.format == PlyHeader::Format::ascii)
    return PlyReader<TextBody>(source, header, property).read();
  return PlyReader<BinaryBody>(source, header, property).read();
}

}  // namespace palpate::io
