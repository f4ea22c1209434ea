// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/clip.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/clip.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/helpers.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/error.hpp"

namespace palpate::skull {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

constexpr double kSplinter = 1000;  ///< [mm^3] smallest piece of bone that is kept
constexpr double kOnPlane = 1e-6;   ///< [mm] rounding of the cut's points

Mesh to_cgal(const SurfaceMesh& mesh) {
  Mesh out;
  for (const Vec3& p : mesh.points) out.add_vertex({p.x(), p.y(), p.z()});
  for (const Triangle& t : mesh.triangles)
    out.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
  return out;
}

SurfaceMesh from_cgal(Mesh& mesh) {
  mesh.collect_garbage();
  SurfaceMesh out;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    out.points.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto f : mesh.faces()) {
    Triangle t;
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f)))
      t[k++] = static_cast<std::int32_t>(v);
    out.triangles.push_back(t);
  }
  return out;
}

/// The same mesh with its points and triangles in an order that does not depend on how the cut was
/// found (CGAL numbers what is new as it comes upon it): the points of `before` first, in their
/// order, then the new ones by place. What is remeshed then comes out the same every time.
Mesh in_order(Mesh& mesh, const SurfaceMesh& before) {
  const SurfaceMesh cut = from_cgal(mesh);
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  std::map<std::array<double, 3>, std::size_t> known;
  for (std::size_t i = 0; i < before.points.size(); ++i) known.emplace(key(before.points[i]), i);
  using Rank = std::pair<std::size_t, std::array<double, 3>>;
  std::vector<std::pair<Rank, std::int32_t>> order;
  for (std::size_t i = 0; i < cut.points.size(); ++i) {
    const auto place = key(cut.points[i]);
    const auto same = known.find(place);
    order.push_back({{same == known.end() ? before.points.size() : same->second, place},
                     static_cast<std::int32_t>(i)});
  }
  std::sort(order.begin(), order.end());
  SurfaceMesh out;
  std::vector<std::int32_t> number(cut.points.size());
  for (const auto& [rank, i] : order) {
    number[i] = static_cast<std::int32_t>(out.points.size());
    out.points.push_back(cut.points[i]);
  }
  for (Triangle t : cut.triangles) {
    for (std::int32_t& v : t) v = number[v];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.triangles.push_back(t);
  }
  std::sort(out.triangles.begin(), out.triangles.end());
  return to_cgal(out);
}

/// The cut's own triangles come long and thin: they and their neighbours are remeshed.
/// @param height  of a point above the tool, [mm]; about 0 on the cut
template <class Height>
void remesh_cut(Mesh& mesh, const Height& height, double edge) {
  std::vector<Mesh::Face_index> cut;
  for (const auto f : mesh.faces())
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      const auto& p = mesh.point(v);
      if (std::abs(height(Vec3(p.x(), p.y(), p.z()))) > kOnPlane) continue;
      cut.push_back(f);
      break;
    }
  if (!cut.empty())
    pmp::isotropic_remeshing(cut, edge, mesh, pmp::parameters::number_of_iterations(3));
}

void drop_splinters(Mesh& mesh) {
  auto part = mesh.add_property_map<Mesh::Face_index, std::size_t>("f:part", 0).first;
  const std::size_t count = pmp::connected_components(mesh, part);
  std::vector<double> volume(count, 0.0);  // of the cones over the origin; right for closed parts
  for (const auto f : mesh.faces()) {
    std::array<Vec3, 3> c;
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      const auto& p = mesh.point(v);
      c[k++] = Vec3(p.x(), p.y(), p.z());
    }
    volume[part[f]] += c[0].dot(c[1].cross(c[2])) / 6;
  }
  std::vector<std::size_t> small;
  for (std::size_t i = 0; i < count; ++i)
    if (volume[i] < kSplinter) small.push_back(i);
  if (!small.empty()) pmp::remove_connected_components(mesh, small, part);
  mesh.remove_property_map(part);
}

std::vector<std::int32_t> nearest_points(const SurfaceMesh& of, const SurfaceMesh& in) {
  std::map<std::array<double, 3>, std::int32_t> kept;
  for (std::size_t i = 0; i < in.points.size(); ++i)
    kept[{in.points[i].x(), in.points[i].y(), in.points[i].z()}] = static_cast<std::int32_t>(i);
  std::vector<std::int32_t> nearest;
  for (const Vec3& p : of.points) {
    if (const auto same = kept.find({p.x(), p.y(), p.z()}); same != kept.end()) {
      nearest.push_back(same->second);
      continue;
    }
    double best = std::numeric_limits<double>::infinity();
    std::int32_t at = 0;
    for (std::size_t i = 0; i < in.points.size(); ++i)
      if (const double d2 = (in.points[i] - p).squaredNorm(); d2 < best) {
        best = d2;
        at = static_cast<std::int32_t>(i);
      }
    nearest.push_back(at);
  }
  return nearest;
}

}  // namespace

Clipped clip_closed(const SurfaceMesh& mesh, const std::vector<registration::CutPlane>& planes,
                    double edge) {
  Mesh work = to_cgal(mesh);
  const double before = pmp::volume(work);
  for (const registration::CutPlane& plane : planes) {
    const Vec3& n = plane.normal;
    try {
      pmp::clip(work, Kernel::Plane_3(n.x(), n.y(), n.z(), -plane.offset),
                pmp::parameters::clip_volume(true).throw_on_self_intersection(true));
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
      throw SolveError("the fitted skull intersects itself where the scan ends");
    }
    work = in_order(work, mesh);
    remesh_cut(
        work, [&](const Vec3& p) { return n.dot(p) - plane.offset; }, edge);
  }
  drop_splinters(work);
  if (work.number_of_faces() == 0) throw SolveError("no bone is left within the scan");
  Clipped out;
  out.removed_mm3 = before - pmp::volume(work);
  out.mesh = from_cgal(work);
  out.origin = nearest_points(out.mesh, mesh);
  return out;
}

Clipped carve(const SurfaceMesh& mesh, const SurfaceMesh& tool, double edge) {
  Mesh work = to_cgal(mesh), away = to_cgal(tool), rest;
  if (!CGAL::is_closed(work)) throw SolveError("the skull's surface is open");
  const double before = pmp::volume(work);
  bool whole = false;
  try {
    whole = pmp::corefine_and_compute_difference(work, away, rest,
                                                 pmp::parameters::throw_on_self_intersection(true));
  } catch (const pmp::Corefinement::Self_intersection_exception&) {
  }
  if (!whole) throw SolveError("the skull's surface intersects itself");
  const auto height = [&](const Vec3& p) {
    double most = -std::numeric_limits<double>::infinity();
    for (const Triangle& t : tool.triangles) {
      const Vec3& a = tool.points[t[0]];
      const Vec3 n = (tool.points[t[1]] - a).cross(tool.points[t[2]] - a).normalized();
      most = std::max(most, n.dot(p - a));
    }
    return most;
  };
  rest = in_order(rest, mesh);
  remesh_cut(rest, height, edge);
  Clipped out;
  out.removed_mm3 = before - pmp::volume(rest);
  out.mesh = from_cgal(rest);
  out.origin = nearest_points(out.mesh, mesh);
  return out;
}

std::size_t count_self_intersections(const SurfaceMesh& mesh) {
  const Mesh work = to_cgal(mesh);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  pmp::self_intersections<CGAL::Sequential_tag>(work, std::back_inserter(pairs));
  return pairs.size();
}

}  // namespace palpate::skull
