// SPDX-License-Identifier: GPL-3.0-or-later
// Embree's tree holds the mesh in single precision, centred on its box. Every query widens the
// single-precision search by a bound on the rounding and decides among the candidates in double, so
// that the answer is that of double arithmetic and does not depend on the tree's shape.
//
// The device takes Embree's default thread settings on purpose: "threads=1" would set TBB's global
// limit and slow the whole program down. Threads are used for building only.
#include "surface/query.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "core/error.hpp"
#include "surface/edge_groups.hpp"
#include "surface/triangle_geometry.hpp"

namespace palpate::surface {
namespace {

// [-] Rounding of centred coordinates and of Embree's box and triangle tests, relative to the
// largest coordinate; 2^-24 per rounding, a few dozen roundings deep. Wider only costs candidates.
constexpr double kFloatSlack = 4e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct ReleaseDevice {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
};
struct ReleaseScene {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

// neighbour[t][k]: the triangle across edge k of t, or t itself on a border.
std::vector<Triangle> edge_neighbours(const SurfaceMesh& mesh) {
  std::vector<Triangle> neighbour(mesh.triangles.size());
  for (std::size_t t = 0; t < neighbour.size(); ++t)
    neighbour[t].fill(static_cast<std::int32_t>(t));
  for_each_edge(mesh.triangles, mesh.points.size(), [&](std::span<const std::int32_t> sides) {
    for (std::size_t i = 1; i < sides.size(); ++i) {
      neighbour[sides[i - 1] / 3][sides[i - 1] % 3] = sides[i] / 3;
      neighbour[sides[i] / 3][sides[i] % 3] = sides[i - 1] / 3;
    }
  });
  return neighbour;
}

struct Nearest {
  TrianglePoint on;
  std::int32_t triangle = -1;
  double distance2 = kInfinity;
};

}  // namespace

struct SurfaceQuery::Tree {
  SurfaceMesh mesh;
  Vec3 center;
  double extent = 0;  // [mm] largest centred coordinate
  std::vector<Vec3> face_normal, vertex_normal;
  std::vector<Triangle> neighbour;
  Device device;
  Scene scene;

  explicit Tree(const SurfaceMesh& source);
  [[nodiscard]] Nearest nearest(const Vec3& p, double max_distance) const;
  [[nodiscard]] Vec3 pseudonormal(std::int32_t triangle, Feature feature) const;
  [[nodiscard]] std::optional<TriangleCrossing> cross(const Vec3& origin, const Vec3& direction,
                                                      std::uint32_t triangle) const {
    const Triangle& t = mesh.triangles[triangle];
    return cross_plane(origin, direction, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
  }
};

SurfaceQuery::Tree::Tree(const SurfaceMesh& source) : mesh(source) {
  if (mesh.empty()) throw InputError("the surface has no triangles, so nothing can be measured");
  if (const auto defect = first_defect(mesh))
    throw InputError(fmt::format("the surface is not usable: {}; repair the scan", *defect));
  const Box box = bounding_box(mesh.points);
  center = box.center();
  extent = 0.5 * box.size().maxCoeff();
  face_normal = triangle_normals(mesh);
  vertex_normal = vertex_normals(mesh);
  neighbour = edge_neighbours(mesh);

  device.reset(rtcNewDevice(nullptr));
  if (!device) throw std::runtime_error("Embree refused to start (rtcNewDevice)");
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST |
                                                           RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.points.size()));
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (!vertices || !corners) throw std::bad_alloc();
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k] - center[k]);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) *corners++ = static_cast<std::uint32_t>(v);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build its tree (out of memory?)");
}

namespace {

struct ClosestSearch {
  const SurfaceMesh* mesh;
  Vec3 p;
  double slack;  // [mm]
  Nearest best;
};

bool visit_closest(RTCPointQueryFunctionArguments* args) {
  auto& search = *static_cast<ClosestSearch*>(args->userPtr);
  const Triangle& t = search.mesh->triangles[args->primID];
  const auto& points = search.mesh->points;
  const TrianglePoint on = closest_on_triangle(search.p, points[t[0]], points[t[1]], points[t[2]]);
  const double distance2 = (on.point - search.p).squaredNorm();
  const auto id = static_cast<std::int32_t>(args->primID);
  Nearest& best = search.best;
  if (distance2 > best.distance2 || (distance2 == best.distance2 && id > best.triangle))
    return false;
  best = {on, id, distance2};
  const auto radius = static_cast<float>(std::sqrt(distance2) + search.slack);
  if (radius >= args->query->radius) return false;
  args->query->radius = radius;
  return true;
}

}  // namespace

Nearest SurfaceQuery::Tree::nearest(const Vec3& p, double max_distance) const {
  const Vec3 q = p - center;
  // The farthest corner of the box is never farther than this; keeps the radius finite.
  const double reach = std::sqrt(3.0) * (q.cwiseAbs().maxCoeff() + extent);
  ClosestSearch search{&mesh, p, kFloatSlack * (reach + 1e-30), {}};
  search.best.distance2 = max_distance < 1e150 ? max_distance * max_distance : kInfinity;
  search.best.triangle = std::numeric_limits<std::int32_t>::max();

  RTCPointQuery query{};
  query.x = static_cast<float>(q.x());
  query.y = static_cast<float>(q.y());
  query.z = static_cast<float>(q.z());
  query.radius = static_cast<float>(std::min(reach, max_distance) + 2 * search.slack);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.get(), &query, &context, visit_closest, &search);
  if (search.best.triangle == std::numeric_limits<std::int32_t>::max()) return {};
  return search.best;
}

Vec3 SurfaceQuery::Tree::pseudonormal(std::int32_t triangle, Feature feature) const {
  const int f = static_cast<int>(feature);
  if (feature == Feature::face) return face_normal[triangle];
  if (f < static_cast<int>(Feature::vertex0)) {
    const int k = f - static_cast<int>(Feature::edge0);
    return face_normal[triangle] + face_normal[neighbour[triangle][k]];
  }
  return vertex_normal[mesh.triangles[triangle][f - static_cast<int>(Feature::vertex0)]];
}

SurfaceQuery::SurfaceQuery(const SurfaceMesh& mesh) : tree_(std::make_unique<Tree>(mesh)) {}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;
const SurfaceMesh& SurfaceQuery::mesh() const {
  return tree_->mesh;
}

ClosestPoint SurfaceQuery::closest(const Vec3& p, double max_distance) const {
  const Nearest n = tree_->nearest(p, max_distance);
  return {n.on.point, n.on.barycentric, n.triangle, std::sqrt(n.distance2)};
}

std::pair<ClosestPoint, double> SurfaceQuery::closest_with_sign(const Vec3& p) const {
  const Nearest n = tree_->nearest(p, 1e200);
  const double side = tree_->pseudonormal(n.triangle, n.on.feature).dot(p - n.on.point);
  const double distance = std::sqrt(n.distance2);
  return {{n.on.point, n.on.barycentric, n.triangle, distance}, side < 0 ? -distance : distance};
}

double SurfaceQuery::signed_distance(const Vec3& p) const {
  return closest_with_sign(p).second;
}

namespace {

// Embree hands every crossing that it finds to the filter, which measures it again in double.
struct CastContext {
  RTCIntersectContext embree;  // first, so that the filter can find the rest
  const SurfaceMesh* mesh;
  Vec3 origin, direction;
  double min_distance, max_distance;
  bool collect;  // second pass: look at every candidate, let Embree accept none
  double best = kInfinity;
  std::uint32_t triangle = RTC_INVALID_GEOMETRY_ID;
  Vec3 barycentric = Vec3::Zero();
};

void filter_crossing(const RTCFilterFunctionNArguments* args) {
  auto& cast = *reinterpret_cast<CastContext*>(args->context);
  const std::uint32_t id = RTCHitN_primID(args->hit, args->N, 0);
  const Triangle& t = cast.mesh->triangles[id];
  const auto& points = cast.mesh->points;
  const auto hit =
      cross_plane(cast.origin, cast.direction, points[t[0]], points[t[1]], points[t[2]]);
  const bool inside = hit && hit->t > cast.min_distance && hit->t <= cast.max_distance;
  if (!inside || cast.collect) args->valid[0] = 0;
  if (!inside || !cast.collect) return;
  if (hit->t < cast.best || (hit->t == cast.best && id < cast.triangle)) {
    cast.best = hit->t;
    cast.triangle = id;
    cast.barycentric = hit->barycentric;
  }
}

RTCRayHit make_ray(const Vec3& origin, const Vec3& direction, double near, double far) {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tnear = static_cast<float>(near);
  ray.ray.tfar = static_cast<float>(far);
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

}  // namespace

std::optional<RayHit> SurfaceQuery::cast(const Vec3& origin, const Vec3& direction,
                                         double max_distance, double min_distance) const {
  const Vec3 o = origin - tree_->center;
  const double reach = std::sqrt(3.0) * (o.cwiseAbs().maxCoeff() + tree_->extent);
  const double slack = kFloatSlack * reach;

  CastContext context{};
  rtcInitIntersectContext(&context.embree);
  context.embree.filter = filter_crossing;
  context.mesh = &tree_->mesh;
  context.origin = origin;
  context.direction = direction;
  context.min_distance = min_distance;
  context.max_distance = max_distance;
  context.best = kInfinity;
  context.triangle = RTC_INVALID_GEOMETRY_ID;

  // First pass: about where. Second: all crossings as near as that, to within rounding. The ray
  // starts a little early, since one that starts on the surface must not lose it to rounding.
  const Vec3 start = o - 2 * slack * direction;
  const double near = 2 * slack + std::max(-slack, min_distance - slack);
  RTCRayHit ray = make_ray(start, direction, near, std::min(max_distance, reach) + 3 * slack);
  rtcIntersect1(tree_->scene.get(), &context.embree, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  context.collect = true;
  RTCRayHit again = make_ray(start, direction, std::max(near, ray.ray.tfar - 2 * slack),
                             static_cast<double>(ray.ray.tfar) + 2 * slack);
  rtcIntersect1(tree_->scene.get(), &context.embree, &again);
  if (context.triangle == RTC_INVALID_GEOMETRY_ID) {  // the window just missed: keep the first
    const auto hit = tree_->cross(origin, direction, ray.hit.primID);
    return RayHit{hit->t, origin + hit->t * direction, hit->barycentric,
                  static_cast<std::int32_t>(ray.hit.primID)};
  }
  return RayHit{context.best, origin + context.best * direction, context.barycentric,
                static_cast<std::int32_t>(context.triangle)};
}

bool SurfaceQuery::blocked(const Vec3& origin, const Vec3& direction, double min_distance) const {
  const Vec3 o = origin - tree_->center;
  const double reach = std::sqrt(3.0) * (o.cwiseAbs().maxCoeff() + tree_->extent);
  RTCRay ray = make_ray(o, direction, min_distance, reach).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(tree_->scene.get(), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace palpate::surface
