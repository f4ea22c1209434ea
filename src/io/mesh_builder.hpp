// SPDX-License-Identifier: Apache-2.0
// Where every reader puts its vertices and polygons: the limits and the checks are here, once.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

#include "core/surface_mesh.hpp"
#include "io/source.hpp"

namespace palpate::io {

inline constexpr std::size_t kMaxTriangles = 20'000'000;
inline constexpr std::size_t kMaxVertices = 3 * kMaxTriangles;  ///< a soup of the largest mesh

/// Adds what a file says, in order; throws InputError through the source where it cannot be used.
/// `where` is only called when something is wrong: it names the element ("line 12").
class MeshBuilder {
 public:
  explicit MeshBuilder(const Source& source) : source_(source) {}

  /// Checks announced counts against the limits before anything is allocated.
  void announce(std::uint64_t vertices, std::uint64_t faces) const;

  template <typename Where>
  void add_point(const Vec3& p, Where&& where) {
    if (!p.allFinite()) refuse_point(where());
    if (mesh.points.size() >= kMaxVertices) refuse_count("vertices", kMaxVertices);
    mesh.points.push_back(p);
  }
  /// Splits the polygon into a fan about its first corner. Indices are range-checked in finish().
  template <typename Where>
  void add_polygon(std::span<const std::int64_t> corners, Where&& where) {
    if (corners.size() < 3) refuse_polygon(where(), corners.size());
    if (mesh.triangles.size() + corners.size() - 2 > kMaxTriangles)
      refuse_count("triangles", kMaxTriangles);
    for (const std::int64_t c : corners)
      if (c < 0 || c >= static_cast<std::int64_t>(kMaxVertices)) refuse_index(where(), c);
    for (std::size_t k = 2; k < corners.size(); ++k)
      mesh.triangles.push_back({static_cast<std::int32_t>(corners[0]),
                                static_cast<std::int32_t>(corners[k - 1]),
                                static_cast<std::int32_t>(corners[k])});
    last_corners_ = corners.size();
    only_triangles_ = only_triangles_ && (corners.size() == 3 || mesh.triangles.size() <= 1);
  }

  /// Range of all indices, at least one triangle. `element` is what the format calls a face.
  /// @throws InputError
  void finish(std::string_view element) const;

  /// For text that ends in a digit without a line end: could the last corner be a cut number? It is
  /// taken as whole when no longer number would be a vertex, or when another face confirms the
  /// edges that lead to it. @throws InputError where neither holds
  /// @param relative  the corner was written relative to the end, so any number could be longer
  void check_last_corner(bool relative = false) const;

  [[nodiscard]] std::size_t unused_points() const;

  SurfaceMesh mesh;

 private:
  [[noreturn]] void refuse_point(const std::string& where) const;
  [[noreturn]] void refuse_polygon(const std::string& where, std::size_t corners) const;
  [[noreturn]] void refuse_index(const std::string& where, std::int64_t index) const;
  [[noreturn]] void refuse_count(std::string_view what, std::size_t limit) const;

  const Source& source_;
  std::size_t last_corners_ = 0;
  bool only_triangles_ = true;
};

}  // namespace palpate::io
