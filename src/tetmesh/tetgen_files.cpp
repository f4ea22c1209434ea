// SPDX-License-Identifier: GPL-3.0-or-later
// TetGen 1.5 manual, sections 5.2 (.node, .poly, .ele). Numbers go through <charconv>, so that the
// locale plays no part.
#include "tetmesh/tetgen_files.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <charconv>
#include <cmath>
#include <iterator>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace palpate::tetmesh {
namespace {

/// Reads one number after the other; knows the line for messages. '#' starts a comment.
class Numbers {
 public:
  explicit Numbers(const std::filesystem::path& path)
      : name_(path.filename().string()), text_(read_file(path)), at_(text_.data()) {}

  template <class T>
  T next(std::string_view what) {
    skip_blanks();
    T value{};
    const auto [end, error] = std::from_chars(at_, stop(), value);
    if (error != std::errc() || (end < stop() && !is_blank(*end)))
      throw SolveError(fmt::format("the mesher's {} line {}: expected {}", name_, line_, what));
    at_ = end;
    return value;
  }
  double next_finite(std::string_view what) {
    const double value = next<double>(what);
    if (!std::isfinite(value))
      throw SolveError(
          fmt::format("the mesher's {} line {}: {} is not finite", name_, line_, what));
    return value;
  }
  void require(bool ok, std::string_view what) const {
    if (!ok) throw SolveError(fmt::format("the mesher's {} line {}: {}", name_, line_, what));
  }
  void require_end() {
    skip_blanks();
    require(at_ == stop(), "more than was announced");
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  [[nodiscard]] const char* stop() const { return text_.data() + text_.size(); }
  void skip_blanks() {
    for (; at_ < stop(); ++at_) {
      if (*at_ == '#')
        while (at_ + 1 < stop() && at_[1] != '\n') ++at_;
      else if (*at_ == '\n')
        ++line_;
      else if (!is_blank(*at_))
        return;
    }
  }
  std::string name_;
  std::string text_;
  const char* at_;
  int line_ = 1;
};

double volume6(const TetgenResult& r, const Tetrahedron& t) {
  Mat3 edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = r.nodes[t[i + 1]] - r.nodes[t[0]];
  return edges.determinant();
}

void read_nodes(const std::filesystem::path& path, TetgenResult& out) {
  Numbers in(path);
  const long count = in.next<long>("the number of nodes");
  in.require(count >= 4 && count < 1L << 31, "a number of nodes that cannot be");
  in.require(in.next<int>("the dimension") == 3, "the dimension is not 3");
  in.require(in.next<int>("the number of attributes") == 0, "unexpected attributes");
  const int markers = in.next<int>("the number of markers");
  in.require(markers == 0 || markers == 1, "unexpected markers");
  out.nodes.reserve(count);
  for (long i = 0; i < count; ++i) {
    in.require(in.next<long>("a node's number") == i, "nodes are not numbered from 0");
    Vec3& p = out.nodes.emplace_back();
    for (int k = 0; k < 3; ++k) p[k] = in.next_finite("a coordinate");
    if (markers) (void)in.next<int>("a marker");
  }
  in.require_end();
}

void read_tets(const std::filesystem::path& path, TetgenResult& out) {
  Numbers in(path);
  const long count = in.next<long>("the number of tetrahedra");
  in.require(count >= 1 && count < 1L << 31, "a number of tetrahedra that cannot be");
  in.require(in.next<int>("the nodes of one") == 4, "not 4 nodes each");
  in.require(in.next<int>("the number of attributes") == 1, "no region numbers");
  const auto nodes = static_cast<std::int32_t>(out.nodes.size());
  out.tets.reserve(count);
  out.label.reserve(count);
  for (long i = 0; i < count; ++i) {
    in.require(in.next<long>("a tetrahedron's number") == i, "not numbered from 0");
    Tetrahedron& t = out.tets.emplace_back();
    for (std::int32_t& node : t) {
      node = in.next<std::int32_t>("a node");
      in.require(node >= 0 && node < nodes, "a node that does not exist");
    }
    const double label = in.next<double>("a region number");
    in.require(label == std::floor(label) && std::abs(label) < 1e9, "a region number is broken");
    out.label.push_back(static_cast<int>(label));
    // TetGen's own orientation is the opposite of ours in some versions; ours is by the sign.
    if (volume6(out, t) < 0) std::swap(t[2], t[3]);
    in.require(volume6(out, t) > 0, "a tetrahedron without volume");
  }
  in.require_end();
}

}  // namespace

void write_poly(const std::filesystem::path& path, std::span<const SurfaceMesh* const> surfaces,
                std::span<const RegionSeed> seeds) {
  std::size_t points = 0, facets = 0;
  for (const SurfaceMesh* s : surfaces) points += s->points.size(), facets += s->triangles.size();
  std::string text;
  text.reserve(points * 64 + facets * 32);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{} 3 0 0\n", points);
  std::size_t next = 0;
  for (const SurfaceMesh* s : surfaces)
    for (const Vec3& p : s->points)
      fmt::format_to(out, "{} {:.17g} {:.17g} {:.17g}\n", next++, p.x(), p.y(), p.z());
  fmt::format_to(out, "{} 0\n", facets);
  std::size_t base = 0;
  for (const SurfaceMesh* s : surfaces) {
    for (const auto& t : s->triangles)
      fmt::format_to(out, "1\n3 {} {} {}\n", base + t[0], base + t[1], base + t[2]);
    base += s->points.size();
  }
  fmt::format_to(out, "0\n{}\n", seeds.size());
  for (std::size_t i = 0; i < seeds.size(); ++i)
    fmt::format_to(out, "{} {:.17g} {:.17g} {:.17g} {} {:.17g}\n", i, seeds[i].point.x(),
                   seeds[i].point.y(), seeds[i].point.z(), seeds[i].label, seeds[i].max_volume);
  write_file(path, text);
}

TetgenResult read_tetgen(const std::filesystem::path& node, const std::filesystem::path& ele) {
  try {
    TetgenResult out;
    read_nodes(node, out);
    read_tets(ele, out);
    return out;
  } catch (const InputError& e) {
    throw SolveError(fmt::format("the mesher left no result: {}", e.what()));
  }
}

}  // namespace palpate::tetmesh
