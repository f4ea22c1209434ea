// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/wrap.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

namespace palpate::surface {

SurfaceMesh alpha_wrap(const SurfaceMesh& mesh, double alpha, double offset) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  std::vector<Point> points;
  points.reserve(mesh.points.size());
  for (const Vec3& p : mesh.points) points.emplace_back(p.x(), p.y(), p.z());
  CGAL::Surface_mesh<Point> wrap;
  CGAL::alpha_wrap_3(points, mesh.triangles, alpha, offset, wrap);

  SurfaceMesh result;
  std::vector<std::int32_t> number(wrap.number_of_vertices() + wrap.number_of_removed_vertices());
  for (const auto v : wrap.vertices()) {
    number[v] = static_cast<std::int32_t>(result.points.size());
    const Point& p = wrap.point(v);
    result.points.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : wrap.faces()) {
    Triangle& t = result.triangles.emplace_back();
    int k = 0;
    for (const auto v : wrap.vertices_around_face(wrap.halfedge(f))) t[k++] = number[v];
  }
  return result;
}

}  // namespace palpate::surface
