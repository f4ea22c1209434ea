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

// The last face ends a - b - c - (first). With c cut to fewer digits the edges b-c and c-a would
// join strangers; with corners missing the closing edge would be a diagonal.
void MeshBuilder::check_last_corner(bool relative) const {
  if (mesh.triangles.empty() || last_corners_ < 3) return;
  const auto n = static_cast<std::int64_t>(mesh.points.size());
  const Triangle last = mesh.triangles.back();
  const bool arity_known = only_triangles_ && last_corners_ == 3;
  // 1-based formats write index + 1: a longer number starts at 10 (index + 1); 0-based at 10 index.
  const bool extendable = relative || 10 * std::int64_t{last[2]} < n;
  if (arity_known && !extendable) return;
  bool closing = false, arriving = false;
  for (std::size_t t = 0; t + (last_corners_ - 2) < mesh.triangles.size(); ++t) {
    const Triangle& f = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t p = f[k], q = f[(k + 1) % 3];
      closing |= (p == last[2] && q == last[0]) || (p == last[0] && q == last[2]);
      arriving |= (p == last[2] && q == last[1]) || (p == last[1] && q == last[2]);
    }
  }
  if (arity_known ? (closing || arriving) : closing) return;
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
