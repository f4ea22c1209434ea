// SPDX-License-Identifier: Apache-2.0
#include "haptics/contact_mesh.hpp"

namespace palpate::haptics {

Vec3 ContactMesh::face_normal(std::int32_t triangle) const {
  const Triangle& t = triangles[static_cast<std::size_t>(triangle)];
  const Vec3& a = points[t[0]];
  return (points[t[1]] - a).cross(points[t[2]] - a).normalized();
}

Vec3 ContactMesh::side_normal(const SurfacePoint& at) const {
  const Feature feature = at.on.feature;
  if (is_vertex(feature)) return normals[triangles[at.triangle][which(feature)]];
  Vec3 n = face_normal(at.triangle);
  if (is_edge(feature)) {
    const std::int32_t other = neighbours[at.triangle][which(feature)];
    if (other >= 0) n += face_normal(other);
  }
  return n;
}

Vec3 ContactMesh::blended_normal(const SurfacePoint& at) const {
  const Triangle& t = triangles[static_cast<std::size_t>(at.triangle)];
  const Vec3 n = at.on.barycentric[0] * normals[t[0]] + at.on.barycentric[1] * normals[t[1]] +
                 at.on.barycentric[2] * normals[t[2]];
  const double length = n.norm();
  return length > 1e-6 ? Vec3(n / length) : face_normal(at.triangle);
}

bool ContactMesh::on_border(const SurfacePoint& at) const {
  const Feature feature = at.on.feature;
  if (feature == Feature::face) return false;
  if (is_edge(feature)) return neighbours[at.triangle][which(feature)] < 0;
  const std::int32_t v = triangles[at.triangle][which(feature)];
  for (std::int32_t i = ring_begin[v]; i < ring_begin[v + 1]; ++i)
    for (int k = 0; k < 3; ++k) {
      const Triangle& t = triangles[ring[i]];
      if ((t[k] == v || t[(k + 1) % 3] == v) && neighbours[ring[i]][k] < 0) return true;
    }
  return false;
}

SurfacePoint ContactMesh::nearest(const Vec3& p, double radius2, const SurfacePoint& known) const {
  SurfacePoint best;
  best.distance2 = radius2;
  if (known.found() && known.distance2 <= radius2) best = known;
  tree.visit_near(p, best.distance2, [&](std::int32_t triangle) {
    const SurfacePoint s = measure(triangle, p);
    if (s.distance2 < best.distance2 ||
        (s.distance2 == best.distance2 && (!best.found() || triangle < best.triangle)))
      best = s;
    return best.distance2;
  });
  return best;
}

SurfacePoint ContactMesh::descend(const Vec3& p, const SurfacePoint& start) const {
  SurfacePoint here = measure(start.triangle, p);
  for (int step = 0; step < kLongestWalk; ++step) {
    SurfacePoint best = here;
    const Feature feature = here.on.feature;
    if (feature == Feature::face) return here;
    if (is_edge(feature)) {
      const std::int32_t other = neighbours[here.triangle][which(feature)];
      if (other >= 0) best = measure(other, p);
    } else {
      const std::int32_t v = triangles[here.triangle][which(feature)];
      for (std::int32_t i = ring_begin[v]; i < ring_begin[v + 1]; ++i) {
        const SurfacePoint s = measure(ring[i], p);
        if (s.distance2 < best.distance2) best = s;
      }
    }
    if (!(best.distance2 < here.distance2)) return here;
    here = best;
  }
  return here;
}

}  // namespace palpate::haptics
