// SPDX-License-Identifier: GPL-3.0-or-later
// Ambient occlusion per point: cosine-weighted directions on a Fibonacci lattice (Marques et al.
// 2013, "Spherical Fibonacci point sets for illumination integrals"); an obstacle counts less the
// farther it is. Each point's sum is taken in a fixed order: same bits for any thread count.
#include "report/ray_mesh.hpp"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace palpate::report {
namespace {

constexpr double kReach = 45;       // [mm] an obstacle farther away casts no shade
constexpr double kStart = 0.15;     // [mm] off the surface, so that it does not shade itself
constexpr double kAfter = 1e-3;     // [mm] a next hit is at least this much farther
constexpr double kRayBudget = 4e6;  // rays for the whole mesh, within the limits below
constexpr int kFewestRays = 12, kMostRays = 64;

struct ReleaseDevice {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
};
struct ReleaseScene {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};

std::vector<Vec3> hemisphere(int count) {
  std::vector<Vec3> out;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double r2 = (i + 0.5) / count, r = std::sqrt(r2), phi = golden * i;
    out.emplace_back(r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r2));
  }
  return out;
}

/// Two tangents without a branch that jumps (Duff et al. 2017).
Mat3 frame_around(const Vec3& n) {
  const double sign = std::copysign(1.0, n.z()), a = -1 / (sign + n.z()), b = n.x() * n.y() * a;
  Mat3 m;
  m.col(0) = Vec3(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
  m.col(1) = Vec3(b, sign + n.y() * n.y() * a, -n.y());
  m.col(2) = n;
  return m;
}

}  // namespace

struct RayMesh::Data {
  SurfaceMesh mesh;
  std::vector<Vec3> point_normals, side_normals;
  std::vector<double> sky;
  Vec3 centre = Vec3::Zero();
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> device;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> scene;

  void build_tree() {
    device.reset(rtcNewDevice(nullptr));
    if (!device) throw InputError("the ray caster could not start");
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.points.size()));
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    if (!points || !corners) throw InputError("not enough memory for the pictures");
    for (const Vec3& p : mesh.points)
      for (int i = 0; i < 3; ++i) *points++ = static_cast<float>(p[i] - centre[i]);
    for (const Triangle& t : mesh.triangles)
      for (int i = 0; i < 3; ++i) *corners++ = static_cast<std::uint32_t>(t[i]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
  }

  [[nodiscard]] RTCRayHit trace(const Vec3& origin, const Vec3& direction, double from,
                                double to) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit r{};
    r.ray.org_x = static_cast<float>(origin.x() - centre.x());
    r.ray.org_y = static_cast<float>(origin.y() - centre.y());
    r.ray.org_z = static_cast<float>(origin.z() - centre.z());
    r.ray.dir_x = static_cast<float>(direction.x());
    r.ray.dir_y = static_cast<float>(direction.y());
    r.ray.dir_z = static_cast<float>(direction.z());
    r.ray.tnear = static_cast<float>(from);
    r.ray.tfar = static_cast<float>(to);
    r.ray.mask = 0xffffffffU;
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &context, &r);
    return r;
  }

  void measure_sky() {
    const double share = kRayBudget / std::max<double>(1, static_cast<double>(mesh.points.size()));
    const auto directions = hemisphere(std::clamp(static_cast<int>(share), kFewestRays, kMostRays));
    sky.assign(mesh.points.size(), 1);
    tbb::parallel_for(std::size_t{0}, mesh.points.size(), [&](std::size_t i) {
      if (point_normals[i].isZero()) return;
      const Mat3 frame = frame_around(point_normals[i]);
      const Vec3 origin = mesh.points[i] + kStart * point_normals[i];
      double shade = 0;
      for (const Vec3& d : directions) {
        const RTCRayHit r = trace(origin, frame * d, 0, kReach);
        if (r.hit.geomID != RTC_INVALID_GEOMETRY_ID) shade += 1 - r.ray.tfar / kReach;
      }
      sky[i] = 1 - shade / static_cast<double>(directions.size());
    });
  }
};

RayMesh::RayMesh(SurfaceMesh mesh) : data_(std::make_unique<Data>()) {
  if (const auto defect = first_defect(mesh)) throw InputError("picture: " + *defect);
  // An open scan has no volume, but about its own centre the sign still tells the winding.
  const Box box = bounding_box(mesh.points);
  if (!mesh.points.empty()) data_->centre = box.center();
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += (mesh.points[a] - data_->centre)
                  .dot((mesh.points[b] - data_->centre).cross(mesh.points[c] - data_->centre));
  if (volume < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  data_->point_normals = vertex_normals(mesh);
  data_->side_normals = triangle_normals(mesh);
  data_->mesh = std::move(mesh);
  if (data_->mesh.empty()) return;
  data_->build_tree();
  data_->measure_sky();
}
RayMesh::~RayMesh() = default;
RayMesh::RayMesh(RayMesh&&) noexcept = default;
RayMesh& RayMesh::operator=(RayMesh&&) noexcept = default;

std::optional<MeshHit> RayMesh::cast(const Vec3& origin, const Vec3& direction, double from) const {
  if (!data_->scene) return std::nullopt;  // nothing to hit
  const RTCRayHit r = data_->trace(origin, direction, from > 0 ? from + kAfter : 0,
                                   std::numeric_limits<float>::infinity());
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const double u = r.hit.u, v = r.hit.v;
  return MeshHit{r.ray.tfar, static_cast<std::int32_t>(r.hit.primID), {1 - u - v, u, v}};
}

Vec3 RayMesh::normal(const MeshHit& hit) const {
  const Triangle& t = data_->mesh.triangles[hit.triangle];
  Vec3 n = Vec3::Zero();
  for (int i = 0; i < 3; ++i) n += hit.barycentric[i] * data_->point_normals[t[i]];
  const double length = n.norm();
  return length > 1e-9 ? Vec3(n / length) : side(hit);
}

Vec3 RayMesh::side(const MeshHit& hit) const {
  return data_->side_normals[hit.triangle];
}

double RayMesh::ambient(const MeshHit& hit) const {
  const Triangle& t = data_->mesh.triangles[hit.triangle];
  double a = 0;
  for (int i = 0; i < 3; ++i) a += hit.barycentric[i] * data_->sky[t[i]];
  return a;
}

const SurfaceMesh& RayMesh::surface() const {
  return data_->mesh;
}

}  // namespace palpate::report
