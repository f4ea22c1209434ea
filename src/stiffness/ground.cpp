// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/ground.hpp"

#include "stiffness/survey.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "core/version.hpp"
#include "fem/lanes/batch.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kOffSkin = 4;  // [mm] a point farther from the working skin is not skin

/// The published recipe holds them.
OrganOptions organs_of(const SweepOptions& o) {
  OrganOptions organs = o.organs;
  if (o.mode == SweepMode::published) organs.organs = Organs::held;
  return organs;
}

VertexStatus status_of(const Spot& spot, bool tissue, Organs organs) {
  if (organs == Organs::held && is_organ(spot.region)) return VertexStatus::held;
  if (!tissue || spot.region == SkinRegion::ear) return VertexStatus::no_bone;
  return VertexStatus::blended;
}

}  // namespace

Ground::Ground(const HeadSurface& h, const SkullFit& skull, const SkinPoints& points,
               const SweepOptions& o, const Progress& progress)
    : head(h), options(o), skin(h.skin), carriers(h, skull, organs_of(o)), flesh(o.tissue, h) {
  limits.no_bone_beyond = o.no_bone_beyond;
  for (int i = 1; i <= o.loads; ++i) forces.push_back(o.max_force * i / o.loads);
  const std::vector<Vec3> normals = smoothed_normals(h.skin, o.tool_radius);

  std::map<std::array<double, 3>, std::int32_t> known;
  std::vector<Vec3> position;
  for (std::size_t p = 0; p < points.position.size(); ++p) {
    const Vec3& at = points.position[p];
    const auto [entry, fresh] =
        known.try_emplace({at.x(), at.y(), at.z()}, static_cast<std::int32_t>(position.size()));
    if (fresh) {
      position.push_back(at);
      spots.push_back({{}, points.region[p], VertexStatus::no_bone, kNan, 0, {}});
    }
    spot_of.push_back(entry->second);
  }
  parallel(static_cast<int>(spots.size()), o, progress, 0, 0.04, [&](int s) {
    Spot& spot = spots[s];
    const surface::ClosestPoint at = skin.closest(position[s]);
    if (!(at.distance <= kOffSkin)) return;
    Vec3 normal = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      normal += at.barycentric[i] * normals[h.skin.triangles[at.triangle][i]];
    spot.frame = site_frame(at.point, normal);
    const auto found = site_features(spot.frame, o.tool_radius, skin, carriers.query(), limits);
    const bool tissue = found && !leaves_tissue(spot.frame, found->depth, skin);
    if (tissue) spot.depth = found->depth;
    spot.status = status_of(spot, tissue, organs_of(o).organs);
    if (spot.status != VertexStatus::blended) return;
    spot.shape = found->shape;
    spot.organ = carriers.organ_share(spot.frame.origin, spot.frame.normal(), o.tool_radius);
  });
}

std::uint64_t Ground::fingerprint() const {
  Fingerprint f;
  f.add(std::string(kVersion));
  f.add(static_cast<double>(fem::lanes::best_instruction_set()));
  for (const SurfaceMesh* mesh : {&head.skin, &carriers.query().mesh()}) {
    for (const Vec3& p : mesh->points) f.add(std::as_bytes(std::span(p.data(), 3)));
    for (const Triangle& t : mesh->triangles) f.add(std::as_bytes(std::span(t)));
  }
  for (const Spot& s : spots) {
    f.add(std::as_bytes(std::span(s.frame.origin.data(), 3)));
    f.add(std::as_bytes(std::span(s.frame.axes.data(), 9)));
  }
  for (const double x : forces) f.add(x);
  const TissueModel& t = options.tissue;
  for (const double x : {options.tool_radius, options.no_bone_beyond, static_cast<double>(t.kind),
                         static_cast<double>(t.law), t.youngs_modulus, t.poissons_ratio, t.blend})
    f.add(x);
  if (t.kind == TissueKind::regional) {
    for (const double x : t.by_region) f.add(x);
    for (const SkinRegion r : head.region) f.add(static_cast<double>(r));
  }
  for (const Spot& s : spots) f.add(s.organ);
  for (const double x : {options.organs.give, options.organs.give_error}) f.add(x);
  if (options.mode == SweepMode::published)
    for (const double x : {options.published.reach, options.published.max_volume}) f.add(x);
  for (const TissueLayer& l : t.layers)
    for (const double x : {l.share, l.youngs_modulus, l.poissons_ratio, static_cast<double>(l.law)})
      f.add(x);
  return f.value();
}

StiffnessMap survey(const HeadSurface& head, const SkullFit& skull, const SkinPoints& points,
                    const SweepOptions& options, const Progress& progress) {
  const Ground ground(head, skull, points, options, progress);
  StiffnessMap map;
  map.tool_radius = options.tool_radius;
  map.region = points.region;
  map.error.assign(points.position.size(), kNan);
  for (const std::int32_t s : ground.spot_of) {
    const Spot& spot = ground.spots[static_cast<std::size_t>(s)];
    map.status.push_back(spot.status);
    map.depth.push_back(spot.depth);
  }
  return map;
}

}  // namespace palpate::stiffness
