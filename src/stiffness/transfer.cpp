// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "stiffness/site_features.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kOffSkin = 4;         // [mm] a point farther from the working skin is not skin
constexpr double kSamePoint = 1e-6;    // [mm] a point this near to a solved one is that point
constexpr double kNoBoneBeyond = 1e3;  // [mm] depth is measured as far as it goes

/// Rows of the map mixed with the corners' weights; corners without a curve are left out.
void mix(const StiffnessMap& from, const Triangle& corner, const Vec3& weight, StiffnessMap& to,
         std::size_t p) {
  const std::size_t loads = from.forces.size();
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    if (from.has_curve(corner[i])) sum += std::max(weight[i], 0.0);
  const std::size_t rings = from.dents.radii.size();
  std::fill_n(to.displacement.begin() + p * loads, loads, 0.0);
  std::fill_n(to.dents.share.begin() + p * rings, rings, 0.0);
  to.error[p] = 0;
  for (int i = 0; i < 3; ++i) {
    if (!from.has_curve(corner[i])) continue;
    const double w = std::max(weight[i], 0.0) / sum;
    for (std::size_t l = 0; l < loads; ++l)
      to.displacement[p * loads + l] += w * from.displacement[corner[i] * loads + l];
    for (std::size_t r = 0; r < rings; ++r)
      to.dents.share[p * rings + r] += w * from.dents.share[corner[i] * rings + r];
    to.error[p] += w * from.error[corner[i]];
  }
}

StiffnessMap empty_map(const StiffnessMap& like, const std::vector<SkinRegion>& region) {
  StiffnessMap map;
  map.tool_radius = like.tool_radius;
  map.forces = like.forces;
  map.displacement.assign(region.size() * like.forces.size(), kNan);
  map.status.assign(region.size(), VertexStatus::no_bone);
  map.error.assign(region.size(), kNan);
  map.depth.assign(region.size(), kNan);
  map.region = region;
  map.method.assign(region.size(), SolveMethod::none);
  map.dents = like.dents;
  map.dents.share.assign(region.size() * like.dents.radii.size(), kNan);
  return map;
}

}  // namespace

StiffnessMap transfer(const StiffnessMap& map, const HeadSurface& head, const SkullFit& skull,
                      const SkinPoints& points, const OrganOptions& organs) {
  const std::vector<SkinRegion>& region = points.region;
  if (region.size() != points.position.size())
    throw InputError("transfer needs one region per point");
  const surface::SurfaceQuery skin(head.skin);
  const Carriers carriers(head, skull, organs);
  const std::vector<Vec3> smooth = smoothed_normals(head.skin, map.tool_radius);
  StiffnessMap out = empty_map(map, region);
  for (std::size_t p = 0; p < region.size(); ++p) {
    const Vec3& point = points.position[p];
    const surface::ClosestPoint at = skin.closest(point);
    if (!(at.distance <= kOffSkin)) continue;
    const Triangle& corner = head.skin.triangles[at.triangle];
    Vec3 normal = Vec3::Zero();
    for (int i = 0; i < 3; ++i) normal += at.barycentric[i] * smooth[corner[i]];
    const auto hit = carriers.query().cast(point, -normal.normalized(), kNoBoneBeyond);

    int nearest = 0;
    at.barycentric.maxCoeff(&nearest);
    out.status[p] = map.status[corner[nearest]];
    if (organs.organs == Organs::held && is_organ(region[p])) out.status[p] = VertexStatus::held;
    if (region[p] == SkinRegion::ear) out.status[p] = VertexStatus::no_bone;
    if (hit && out.status[p] != VertexStatus::no_bone) out.depth[p] = hit->distance;
    if (!out.has_curve(p)) continue;
    const bool same = (point - head.skin.points[corner[nearest]]).norm() <= kSamePoint;
    if (!same) out.status[p] = VertexStatus::blended;
    out.method[p] =
        same && !map.method.empty() ? map.method[corner[nearest]] : SolveMethod::surrogate;
    mix(map, corner, same ? Vec3(Vec3::Unit(nearest)) : at.barycentric, out, p);
  }
  return out;
}

}  // namespace palpate::stiffness
