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
    bool unknown = false, cap = true;
    for (const std::int32_t v : t)
      unknown = unknown || ends_.no_scan[v] ||
                (static_cast<std::size_t>(v) < head.region.size() && stands_off(head.region[v]));
    for (const std::int32_t v : t) cap = cap && ends_.cap[v];
    cap_.push_back(cap);
    unknown_.push_back(unknown);
  }
}

SkinDepth SkinField::at(const Vec3& p) const {
  const surface::ClosestPoint near = query_.closest(p);
  SkinDepth d;
  d.depth = -query_.signed_distance(p);
  // Both signs: inside, depth grows away from the skin; outside, it grows towards it.
  d.gradient = std::abs(d.depth) > 1e-9 ? Vec3((p - near.point) / d.depth) : Vec3::Zero();
  d.open = cap_[near.triangle] || (d.depth < 0 && behind_a_cap(ends_, p));
  d.known = !unknown_[near.triangle] && !d.open;
  return d;
}

}  // namespace palpate::skull
