// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/skin_field.hpp"

namespace palpate::skull {
namespace {

/// Skin that says nothing about the bone below: auricles stand off the head, the neck has none.
bool stands_off(SkinRegion region) {
  return region == SkinRegion::ear || region == SkinRegion::neck;
}

/// Caps are patches, their planes are not: only outside the skin is a place behind a plane open.
bool behind_a_cap(const registration::ScanEnds& ends, const Vec3& p) {
  for (const registration::CutPlane& plane : ends.planes)
    if (plane.normal.dot(p) > plane.offset) return true;
  return false;
}

}  // namespace

SkinField::SkinField(const HeadSurface& head)
    : query_(head.skin), ends_(registration::find_scan_ends(head)) {
  for (const Triangle& t : head.skin.triangles) {
    bool filled = false, off = false, no_scan = false, cap = true, any_cap = false, closed = false,
         other = false;
    for (const std::int32_t v : t) {
      const auto i = static_cast<std::size_t>(v);
      off = off || (i < head.region.size() && stands_off(head.region[i]));
      no_scan = no_scan || ends_.no_scan[i];
      cap = cap && ends_.cap[i];
      any_cap = any_cap || ends_.cap[i];
      closed = closed || (i < head.filled.size() && head.filled[i] == 1);
      filled = filled || (i < head.filled.size() && head.filled[i] != 0);
      other = other || (i < head.filled.size() && head.filled[i] == 2);
    }
    const auto& points = head.skin.points;
    normal_.push_back(
        (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).stableNormalized());
    cap_.push_back(cap);
    scanned_.push_back(!filled && !any_cap);
    unknown_.push_back(no_scan || off);
    completed_.push_back(other && !off && !any_cap && !closed);
  }
}

SkinDepth SkinField::at(const Vec3& p) const {
  const auto [near, distance] = query_.closest_with_sign(p);
  SkinDepth d;
  d.depth = -distance;
  // Both signs: inside, depth grows away from the skin; outside, it grows towards it.
  d.gradient = std::abs(d.depth) > 1e-9 ? Vec3((p - near.point) / d.depth) : Vec3::Zero();
  d.open = cap_[near.triangle] || (d.depth < 0 && behind_a_cap(ends_, p));
  d.known = !unknown_[near.triangle] && !d.open;
  d.completed = completed_[near.triangle] && !d.open;
  return d;
}

std::optional<SkinExit> SkinField::exit(const Vec3& p, const Vec3& direction, double reach) const {
  const auto hit = query_.cast(p, direction, reach);
  if (!hit || !scanned_[hit->triangle]) return std::nullopt;
  return SkinExit{hit->distance, normal_[hit->triangle]};
}

}  // namespace palpate::skull
