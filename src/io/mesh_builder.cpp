// SPDX-License-Identifier: Apache-2.0
#include "io/mesh_builder.hpp"

#include <fmt/format.h>

#include <vector>

namespace palpate::io {

void MeshBuilder::announce(std::uint64_t vertices, std::uint64_t faces) const {
  if (vertices > kMaxVertices) refuse_count("vertices", kMaxVertices);
  if (faces > kMaxTriangles) refuse_count("triangles", kMaxTriangles);
}

void MeshBuilder::refuse_point(const std::string& where) const {
  source_.fail(where, "a coordinate is NaN or infinite", "remove the vertex or repair its values");
}

void MeshBuilder::refuse_polygon(const std::string& where, std::size_t corners) const {
  source_.fail(where, fmt::format("a face with {} corners", corners),
               "remove it, or export the mesh again if the file was cut");
}

void MeshBuilder::refuse_index(const std::string& where, std::int64_t index) const {
  source_.fail(where,
               fmt::format("refers to vertex {} (counted from 0), which is not there", index),
               "export the mesh again");
}

void MeshBuilder::refuse_count(std::string_view what, std::size_t limit) const {
  source_.fail("", fmt::format("more than {} million {}", limit / 1'000'000, what),
               "decimate the scan below the limit of 20 million triangles");
}

void MeshBuilder::finish(std::string_view element) const {
  if (mesh.points.empty())
    source_.fail("", "no vertices", "export a triangle mesh; is the file cut?");
  if (mesh.triangles.empty())
    source_.fail("", fmt::format("{} vertices but no faces", mesh.points.size()),
                 "export a surface, not a point cloud; is the file cut?");
  const auto n = static_cast<std::int32_t>(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t c : mesh.triangles[t])
      if (c < 0 || c >= n)
        source_.fail(fmt::format("{} (triangle {})", element, t),
                     fmt::format("refers to vertex {} (counted from 0) but there are {}", c, n),
                     "export the mesh again; is the file cut?");
}

namespace {
/// How the faces before the last use one of its edges.
struct EdgeUse {
  int same = 0, opposite = 0;
  [[nodiscard]] bool possible() const { return same == 0 && opposite <= 1; }  // a manifold's
  [[nodiscard]] bool confirmed() const { return possible() && opposite == 1; }
};
}  // namespace

// The last face ends a - b - c (- first). With c cut to fewer digits the edges b-c and c-first
// would join strangers, or vertices that other faces join already; with corners missing the edge
// c-first would be a diagonal.
void MeshBuilder::check_last_corner(bool relative) const {
  if (mesh.triangles.empty() || last_corners_ < 3) return;
  const auto n = static_cast<std::int64_t>(mesh.points.size());
  const Triangle last = mesh.triangles.back();
  const bool arity_known = only_triangles_ && last_corners_ == 3;
  // A longer number starts at 10 (index + 1) where the format counts from 1, else at 10 index.
  const bool extendable = relative || 10 * std::int64_t{last[2]} < n;
  if (arity_known && !extendable) return;
  EdgeUse arriving, closing;
  const auto count = [](EdgeUse& use, std::int32_t p, std::int32_t q, std::int32_t from,
                        std::int32_t to) {
    use.same += p == from && q == to;
    use.opposite += p == to && q == from;
  };
  for (std::size_t t = 0; t + (last_corners_ - 2) < mesh.triangles.size(); ++t) {
    const Triangle& f = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      count(arriving, f[k], f[(k + 1) % 3], last[1], last[2]);
      count(closing, f[k], f[(k + 1) % 3], last[2], last[0]);
    }
  }
  const bool possible = arriving.possible() && closing.possible();
  const bool confirmed = closing.confirmed() || (arity_known && arriving.confirmed());
  if (possible && confirmed) return;
  source_.fail("last line", "ends in the middle: the last face has no line end and fits no other",
               "export the mesh again, or end the last line if the file is whole");
}

std::size_t MeshBuilder::unused_points() const {
  std::vector<bool> used(mesh.points.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t c : t) used[static_cast<std::size_t>(c)] = true;
  std::size_t unused = 0;
  for (const bool u : used) unused += !u;
  return unused;
}

}  // namespace palpate::io
