// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/skin_field.hpp"

namespace palpate::skull {
namespace {

/// Skin that says nothing about the bone below: auricles stand off the head, the neck has none.
bool stands_off(SkinRegion region) {
  return region == SkinRegion::ear || region == SkinRegion::neck;
}

}  // namespace

SkinField::SkinField(const HeadSurface& head)
    : query_(head.skin), ends_(registration::find_scan_ends(head)) {
  for (const Triangle& t : head.skin.triangles) {
    bool unknown = false;
    for (const std::int32_t v : t)
      unknown = unknown || ends_.no_scan[v] ||
                (static_cast<std::size_t>(v) < head.region.size() && stands_off(head.region[v]));
    unknown_.push_back(unknown);
  }
}

SkinDepth SkinField::at(const Vec3& p) const {
  const surface::ClosestPoint near = query_.closest(p);
  SkinDepth d;
  d.depth = -query_.signed_distance(p);
  // Both signs: inside, depth grows away from the skin; outside, it grows towards it.
  d.gradient = std::abs(d.depth) > 1e-9 ? Vec3((p - near.point) / d.depth) : Vec3::Zero();
  d.known = !unknown_[near.triangle] && !beyond_scan(p);
  return d;
}

bool SkinField::beyond_scan(const Vec3& p) const {
  for (const registration::CutPlane& plane : ends_.planes)
    if (plane.normal.dot(p) > plane.offset) return true;
  return false;
}

}  // namespace palpate::skull
