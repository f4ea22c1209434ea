// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/intersections.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

namespace palpate::surface {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Box3 = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

// Rotates both triangles so that their `count` shared corners come first, in the same order.
int align_shared(Triangle& s, Triangle& t) {
  int count = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = count; j < 3; ++j)
      if (i >= count && s[i] == t[j]) {
        std::swap(s[count], s[i]);
        std::swap(t[count], t[j]);
        ++count;
        break;
      }
  return count;
}

bool improper(const std::vector<Point>& p, Triangle s, Triangle t) {
  const int shared = align_shared(s, t);
  if (shared == 3) return true;
  if (shared == 2)  // folded flat onto each other
    return CGAL::coplanar(p[s[0]], p[s[1]], p[s[2]], p[t[2]]) &&
           CGAL::coplanar_orientation(p[s[0]], p[s[1]], p[s[2]], p[t[2]]) == CGAL::POSITIVE;
  const Kernel::Triangle_3 a(p[s[0]], p[s[1]], p[s[2]]), b(p[t[0]], p[t[1]], p[t[2]]);
  if (shared == 1)
    return CGAL::do_intersect(a, Kernel::Segment_3(p[t[1]], p[t[2]])) ||
           CGAL::do_intersect(b, Kernel::Segment_3(p[s[1]], p[s[2]]));
  return CGAL::do_intersect(a, b);
}

}  // namespace

std::vector<std::pair<std::int32_t, std::int32_t>> self_intersections(const SurfaceMesh& mesh) {
  std::vector<Point> p;
  p.reserve(mesh.points.size());
  for (const Vec3& q : mesh.points) p.emplace_back(q.x(), q.y(), q.z());
  std::vector<std::pair<std::int32_t, std::int32_t>> found;
  std::vector<Box3> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    const auto id = static_cast<std::int32_t>(i);
    if (CGAL::collinear(p[a], p[b], p[c]))
      found.emplace_back(id, id);
    else
      boxes.emplace_back(p[a].bbox() + p[b].bbox() + p[c].bbox(), id);
  }
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box3& x, const Box3& y) {
    const std::int32_t low = std::min(x.info(), y.info()), high = std::max(x.info(), y.info());
    if (improper(p, mesh.triangles[low], mesh.triangles[high])) found.emplace_back(low, high);
  });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace palpate::surface
