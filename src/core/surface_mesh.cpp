// SPDX-License-Identifier: Apache-2.0
#include "core/surface_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

Box bounding_box(const std::vector<Vec3>& points) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Box box{Vec3::Constant(inf), Vec3::Constant(-inf)};
  for (const Vec3& p : points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

static Vec3 area_vector(const SurfaceMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.points[t[0]];
  return 0.5 * (mesh.points[t[1]] - a).cross(mesh.points[t[2]] - a);
}

std::vector<Vec3> triangle_normals(const SurfaceMesh& mesh) {
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    normals.push_back(area_vector(mesh, t).stableNormalized());
  return normals;
}

std::vector<Vec3> vertex_normals(const SurfaceMesh& mesh) {
  std::vector<Vec3> normals(mesh.points.size(), Vec3::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 n = area_vector(mesh, t).stableNormalized();
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = mesh.points[t[k]];
      const Vec3 a = mesh.points[t[(k + 1) % 3]] - p;
      const Vec3 b = mesh.points[t[(k + 2) % 3]] - p;
      normals[t[k]] += std::atan2(a.cross(b).norm(), a.dot(b)) * n;
    }
  }
  for (Vec3& n : normals) n.stableNormalize();
  return normals;
}

double signed_volume(const SurfaceMesh& mesh) {
  if (mesh.points.empty()) return 0;
  const Vec3 origin = bounding_box(mesh.points).center();  // keeps the sum well conditioned
  double volume = 0;
  for (const Triangle& t : mesh.triangles)
    volume += (mesh.points[t[0]] - origin)
                  .dot((mesh.points[t[1]] - origin).cross(mesh.points[t[2]] - origin));
  return volume / 6;
}

SurfaceMesh transformed(SurfaceMesh mesh, const Mat3& linear, const Vec3& translation) {
  for (Vec3& p : mesh.points) p = linear * p + translation;
  return mesh;
}

std::optional<std::string> first_defect(const SurfaceMesh& mesh) {
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (!mesh.points[i].allFinite())
      return fmt::format("vertex {} has a NaN or infinite coordinate", i);
  const auto n = static_cast<std::int64_t>(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::int32_t v : mesh.triangles[i])
      if (v < 0 || v >= n)
        return fmt::format("triangle {} names vertex {}, but there are {} vertices", i, v, n);
  return std::nullopt;
}

}  // namespace palpate
