// SPDX-License-Identifier: GPL-3.0-or-later
// Opening turns the jaw about the condyles while these glide forwards and down along the articular
// eminence: at the widest opening (33 degrees, Ferrario et al. 2005) by 11.9 mm (Travers et al.
// 2000, Arch Oral Biol 45:267). The glide is taken as proportional to the opening.
#include "skull/jaw.hpp"

#include <algorithm>
#include <cmath>

#include "skull/clip.hpp"

namespace palpate::skull {
namespace {

constexpr double kGlidePerRadian = 20.7;  ///< [mm] 11.9 mm in 33 degrees
/// [rad] of the condyles' path below the Frankfurt plane; means of 30 to 40 degrees are published.
constexpr double kPathSlope = 0.6;
/// [mm] from the middle of the porions: the condyles' centre, before and below the ear canals.
const Vec3 kJoint(0, -4, 14);
/// [-] of the distance from alveolar to alveolar point: where the bite's band ends on both sides.
constexpr double kBiteShare = 0.3;
/// [-] of the ramus's height, from the joint: middle and half width of the band there. Higher up,
/// the mastoid would go along.
constexpr double kRamusMiddle = 0.55;
constexpr double kRamusShare = 0.23;
/// [-] of the way from the second molars back to the gonia: over which the band rises.
constexpr double kRise = 0.45;

constexpr double kSlot = 1;       ///< [mm] half of the slot's height between parted teeth
constexpr double kSlotEnd = 0.5;  ///< [-] of the rise: how far back the slot goes
constexpr double kSlotEdge = 3;   ///< [mm] its triangles: the template's own

/// Cubic step and its derivative at t.
struct Step {
  double value, slope;
};
Step step(double t) {
  const double c = std::clamp(t, 0.0, 1.0);
  return {c * c * (3 - 2 * c), 6 * c * (1 - c)};
}

/// Middle and half width of the band at z, with their derivatives.
struct Band {
  double middle, half, middle_slope, half_slope;
};
Band band_at(const Jaw& j, double z) {
  const double length = j.molar - j.ramus;
  const Step back = step((j.molar - z) / length);
  const double rate = -back.slope / length;
  const double bite = j.bite_height + j.bite_slope * (z - j.molar);
  return {bite + back.value * (j.ramus_height - bite),
          j.bite_half + back.value * (j.ramus_half - j.bite_half),
          j.bite_slope * (1 - back.value) + rate * (j.ramus_height - bite),
          rate * (j.ramus_half - j.bite_half)};
}

bool has_jaw_region(const SkullTemplate& skull) {
  return std::any_of(skull.region.begin(), skull.region.end(),
                     [](SkullRegion r) { return r == SkullRegion::jaw || r == SkullRegion::chin; });
}

}  // namespace

Vec3 JawPrior::precision() const {
  return {1 / (opening_sd * opening_sd), 1 / (advance_sd * advance_sd), 1 / (shift_sd * shift_sd)};
}

double Jaw::weight(const Vec3& x) const {
  if (!present) return 0;
  const Band b = band_at(*this, x.z());
  return step(0.5 * (1 + (b.middle - x.y()) / b.half)).value;
}

Vec3 Jaw::weight_gradient(const Vec3& x) const {
  if (!present) return Vec3::Zero();
  const Band b = band_at(*this, x.z());
  const double above = (b.middle - x.y()) / b.half;
  const double slope = 0.5 * step(0.5 * (1 + above)).slope / b.half;
  return {0, -slope, slope * (b.middle_slope - above * b.half_slope)};
}

Jaw find_jaw(const SkullTemplate& skull) {
  Jaw jaw;
  if (!has_jaw_region(skull)) return jaw;
  for (const char* code : {"po_left", "po_right", "go_left", "go_right", "pr", "id", "sM2_left",
                           "sM2_right", "iM2_left", "iM2_right"})
    if (!skull.landmarks.contains(code)) return jaw;
  const auto at = [&](const char* code) { return skull.landmarks.at(code).position; };
  const auto pair = [&](const char* left, const char* right) {
    return Vec3(0.5 * (at(left) + at(right)));
  };
  const Vec3 gonia = pair("go_left", "go_right"), front = 0.5 * (at("pr") + at("id"));
  const Vec3 upper = pair("sM2_left", "sM2_right"), lower = pair("iM2_left", "iM2_right");
  const Vec3 molar = 0.5 * (upper + lower);
  jaw.hinge = pair("po_left", "po_right") + kJoint;
  jaw.bite_height = molar.y();
  jaw.bite_slope = (front.y() - molar.y()) / (front.z() - molar.z());
  jaw.bite_half = kBiteShare * std::min(at("pr").y() - at("id").y(), upper.y() - lower.y());
  const double ramus = jaw.hinge.y() - gonia.y();
  jaw.ramus_height = jaw.hinge.y() - kRamusMiddle * ramus;
  jaw.ramus_half = kRamusShare * ramus;
  jaw.molar = molar.z();
  jaw.ramus = molar.z() - kRise * (molar.z() - gonia.z());
  jaw.present = front.z() > molar.z() && jaw.bite_half > 0 && ramus > 0 && jaw.ramus < jaw.molar;
  return jaw;
}

PartedTeeth part_teeth(const SkullTemplate& skull, const Jaw& jaw) {
  // A slab along the bite, its corners numbered by sides: 1 left, 2 above, 4 in front.
  const Box box = bounding_box(skull.mesh.points);
  const double back = jaw.molar - kSlotEnd * (jaw.molar - jaw.ramus), front = box.high.z() + 10;
  SurfaceMesh slab;
  for (int k = 0; k < 8; ++k) {
    const double z = k & 4 ? front : back;
    slab.points.emplace_back(
        k & 1 ? box.high.x() + 10 : box.low.x() - 10,
        jaw.bite_height + jaw.bite_slope * (z - jaw.molar) + (k & 2 ? kSlot : -kSlot), z);
  }
  slab.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  Clipped cut = carve(skull.mesh, slab, kSlotEdge);
  PartedTeeth parted{skull, jaw};
  parted.skull.mesh = std::move(cut.mesh);
  parted.skull.region.clear();
  for (const std::int32_t i : cut.origin) parted.skull.region.push_back(skull.region[i]);
  parted.jaw.bite_half = kSlot;
  return parted;
}

JawMotion move_jaw(const Jaw& jaw, const JawPose& pose, const Vec3& place, double weight) {
  const Vec3 path(0, -std::sin(kPathSlope), std::cos(kPathSlope));
  const Vec3 glide =
      (kGlidePerRadian * pose.opening + pose.advance) * path + pose.shift * Vec3::UnitX();
  JawMotion m;
  m.turn = Eigen::AngleAxisd(weight * pose.opening, Vec3::UnitX()).toRotationMatrix();
  const Vec3 arm = m.turn * (place - jaw.hinge), turning = Vec3::UnitX().cross(arm);
  m.position = jaw.hinge + arm + weight * glide;
  m.by_pose.col(0) = weight * (turning + kGlidePerRadian * path);
  m.by_pose.col(1) = weight * path;
  m.by_pose.col(2) = weight * Vec3::UnitX();
  m.by_weight = pose.opening * turning + glide;
  return m;
}

}  // namespace palpate::skull
