// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/carriers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "stiffness/site_features.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kLookBack = 2;  // [mm] rays around a site start this far above the tangent plane
constexpr double kReach = 60;    // [mm] of a ray; nothing deeper carries skin
constexpr int kRays = 8;         // around the middle one
constexpr double kNoseEven = 4;  // [mm] over which the nose's normals are averaged
constexpr int kRound = 36;       // points around a globe

void append(SurfaceMesh& to, const SurfaceMesh& part) {
  const auto shift = static_cast<std::int32_t>(to.points.size());
  to.points.insert(to.points.end(), part.points.begin(), part.points.end());
  for (const auto& [a, b, c] : part.triangles)
    to.triangles.push_back({a + shift, b + shift, c + shift});
}

/// The sphere, poles up and down; triangles face outwards.
SurfaceMesh globe(const Vec3& centre, double radius) {
  constexpr int kRows = kRound / 2;
  SurfaceMesh m;
  for (int i = 0; i <= kRows; ++i)
    for (int j = 0; j < kRound; ++j) {
      const double down = std::numbers::pi * i / kRows, turn = 2 * std::numbers::pi * j / kRound;
      m.points.push_back(centre + radius * Vec3(std::sin(down) * std::sin(turn), std::cos(down),
                                                std::sin(down) * std::cos(turn)));
    }
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kRound; ++j) {
      const int a = i * kRound + j, b = i * kRound + (j + 1) % kRound;
      if (i > 0) m.triangles.push_back({a, a + kRound, b});
      if (i + 1 < kRows) m.triangles.push_back({b, a + kRound, b + kRound});
    }
  return m;
}

/// Behind the skin of one eye, as far in front as the lid allows. Nothing without such skin.
SurfaceMesh eye(const HeadSurface& head, double side, const OrganOptions& o) {
  Vec3 middle = Vec3::Zero();
  std::vector<Vec3> skin;
  for (std::size_t p = 0; p < head.skin.points.size(); ++p)
    if (head.region[p] == SkinRegion::eye && side * head.skin.points[p].x() > 0) {
      skin.push_back(head.skin.points[p]);
      middle += skin.back();
    }
  if (skin.empty()) return {};
  middle /= static_cast<double>(skin.size());
  const double room = o.globe_radius + o.lid;
  double front = std::numeric_limits<double>::infinity();
  for (const Vec3& p : skin) {
    const double across2 = (p - middle).head<2>().squaredNorm();
    if (across2 < room * room) front = std::min(front, p.z() - std::sqrt(room * room - across2));
  }
  if (!std::isfinite(front)) return {};
  return globe({middle.x(), middle.y(), front}, o.globe_radius);
}

/// The nose's skin and one ring around it moved inwards by the cover, but where bone lies in front
/// of that. Without the ring rays from the nose's border would slip past the sheet's.
SurfaceMesh cartilage(const HeadSurface& head, const surface::SurfaceQuery& bone,
                      const OrganOptions& o) {
  const std::vector<Vec3> normal = smoothed_normals(head.skin, kNoseEven);
  std::vector<std::int32_t> number(head.skin.points.size(), -1);
  SurfaceMesh m;
  std::vector<std::uint8_t> wanted(number.size(), 0);
  for (const auto& [a, b, c] : head.skin.triangles)
    for (const std::int32_t v : {a, b, c})
      if (head.region[v] == SkinRegion::nose) wanted[a] = wanted[b] = wanted[c] = 1;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (!wanted[p]) continue;
    const Vec3& at = head.skin.points[p];
    if (bone.cast(at, -normal[p], o.nose_cover)) continue;
    number[p] = static_cast<std::int32_t>(m.points.size());
    m.points.push_back(at - o.nose_cover * normal[p]);
  }
  for (const auto& [a, b, c] : head.skin.triangles)
    if (number[a] >= 0 && number[b] >= 0 && number[c] >= 0)
      m.triangles.push_back({number[a], number[b], number[c]});
  return m;
}

SurfaceMesh all_carriers(const HeadSurface& head, const SkullFit& skull, const OrganOptions& o) {
  SurfaceMesh all = skull.mesh;
  if (o.organs == Organs::held) return all;
  for (const double side : {-1.0, 1.0}) append(all, eye(head, side, o));
  append(all, cartilage(head, surface::SurfaceQuery(skull.mesh), o));
  return all;
}

}  // namespace

Carriers::Carriers(const HeadSurface& head, const SkullFit& skull, const OrganOptions& options)
    : query_(all_carriers(head, skull, options)),
      bone_triangles_(static_cast<std::int32_t>(skull.mesh.triangles.size())) {}

double Carriers::organ_share(const Vec3& at, const Vec3& normal, double tool_radius) const {
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  int rays = 0, organ = 0;
  for (int k = 0; k <= kRays; ++k) {
    const double turn = 2 * std::numbers::pi * k / kRays, r = k == kRays ? 0 : tool_radius / 2;
    const Vec3 from = at + r * (std::cos(turn) * u + std::sin(turn) * v) + kLookBack * normal;
    const auto hit = query_.cast(from, -normal, kReach);
    if (!hit) continue;
    ++rays;
    organ += hit->triangle >= bone_triangles_;
  }
  return rays > 0 ? static_cast<double>(organ) / rays : 0;
}

}  // namespace palpate::stiffness
