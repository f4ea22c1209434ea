// SPDX-License-Identifier: GPL-3.0-or-later
// Borders are drawn once, on the mean face in [mm] of its head frame (origin midway between the
// outer eye corners; nose tip (0, -37, 33), chin (0, -93, 13), ear centres (+-76, -16, -85)); a
// head's point is carried there by FaceWarp and named. docs/method/regions.md shows the drawing.
#include "landmarks/regions.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/error.hpp"
#include "landmarks/face_warp.hpp"

namespace palpate::landmarks {
namespace {

struct Knot {
  double at, value;
};

// Piecewise cubic through the knots with zero slope at each: smooth, no overshoot.
template <std::size_t N>
double curve(const std::array<Knot, N>& knots, double at) {
  if (at <= knots.front().at) return knots.front().value;
  for (std::size_t i = 1; i < N; ++i) {
    if (at > knots[i].at) continue;
    const double t = (at - knots[i - 1].at) / (knots[i].at - knots[i - 1].at);
    return knots[i - 1].value + t * t * (3 - 2 * t) * (knots[i].value - knots[i - 1].value);
  }
  return knots.back().value;
}

bool in_ellipse(double x, double y, double rx, double ry) {
  return (x * x) / (rx * rx) + (y * y) / (ry * ry) < 1;
}

// The place on the mean face; a = |x|, since every border is the same on both sides.
struct Place {
  double a, y, z;
};

// Lower border of the mandible from the menton to the angle, on to the ear lobe and the nape.
double lower_border(double z) {
  return curve(
      std::array<Knot, 7>{
          {{-165, -62}, {-110, -52}, {-84, -50}, {-68, -76}, {-50, -88}, {-22, -102}, {4, -112}}},
      z);
}

// The jaw line that a finger finds: a band of 20 mm along the mandible's lower border and its
// angle.
constexpr double kJawBand = 20;  // [mm]
double jaw_top(double z) {
  return lower_border(z) + kJawBand;
}

// Lower end of the cheek: above the body of the mandible in front, in front of the masseter behind.
double cheek_low(double z) {
  return curve(std::array<Knot, 4>{{{-60, -34}, {-46, -42}, {-32, -72}, {0, -86}}}, z);
}

// The zygomatic bone and arch: lower and upper limit along the way from the ear to the face.
double cheekbone_low(double z) {
  return curve(std::array<Knot, 4>{{{-66, -20}, {-42, -24}, {-16, -33}, {6, -36}}}, z);
}
double cheekbone_high(double z) {
  return curve(std::array<Knot, 4>{{{-66, -4}, {-42, -6}, {-16, -10}, {6, -16}}}, z);
}

// Half width of the nose with its sides.
double nose_half_width(double y) {
  return curve(std::array<Knot, 5>{{{-52, 17}, {-36, 20.5}, {-26, 17}, {-8, 10}, {8, 8}}}, y);
}

// Brow band over the orbit's upper rim: lower and upper edge, sinking to the side.
double brow_low(double a) {
  return curve(std::array<Knot, 4>{{{0, 9}, {16, 11}, {34, 13}, {52, 8}}}, a);
}
double brow_high(double a) {
  return curve(std::array<Knot, 4>{{{0, 27}, {16, 28}, {34, 28}, {54, 20}}}, a);
}

bool is_ear(const Place& p) {
  return p.a > 58 && in_ellipse(p.z + 83, p.y + 15, 19, 34);
}
bool is_neck(const Place& p) {
  return p.y < lower_border(p.z);
}
bool is_eye(const Place& p) {
  return p.z > -18 && in_ellipse(p.a - 28.5, p.y + 2, 17, 13);
}
bool is_nose(const Place& p) {
  return p.z > -10 && p.y > -51 && p.y < 9 && p.a < nose_half_width(p.y);
}
bool is_lips(const Place& p) {
  const double half_width = curve(std::array<Knot, 3>{{{-80, 12}, {-64, 27}, {-50, 19}}}, p.y);
  return p.z > -15 && p.y > -80 && p.y <= -50 && p.a < half_width;
}
// The chin that faces forwards; its underside belongs to the jaw's lower border.
constexpr double kGnathion = -105;  // [mm]
bool is_chin(const Place& p) {
  return p.y < -78 && p.y > kGnathion && in_ellipse(p.a, p.y + 94, 24, 21) && p.z > -18;
}
bool is_brow(const Place& p) {
  return p.z > -28 && p.a < 54 && p.y > brow_low(p.a) && p.y <= brow_high(p.a);
}
bool is_forehead(const Place& p) {
  // Hairline above, temporal line at the side.
  const double side = curve(std::array<Knot, 3>{{{24, 50}, {45, 52}, {85, 44}}}, p.y);
  return p.z > -50 && p.y > brow_high(p.a) && p.y < 82 && p.a < side;
}
bool is_cheekbone(const Place& p) {
  return p.z > -66 && p.a > 26 && p.y > cheekbone_low(p.z) && p.y <= cheekbone_high(p.z);
}
bool is_jaw(const Place& p) {
  return p.z > -72 && (p.a > 18 || p.y <= kGnathion) && p.y <= jaw_top(p.z);
}
bool is_cheek(const Place& p) {
  return p.z > -50 && p.a > 22 && p.y > cheek_low(p.z) && p.y <= cheekbone_low(p.z);
}
// The vault above the temples, the ears and the line from the ears to below the occiput.
bool is_cranium(const Place& p) {
  const double low =
      curve(std::array<Knot, 5>{{{-165, -30}, {-120, -20}, {-95, 24}, {-40, 42}, {-10, 30}}}, p.z);
  return p.y > low;
}

// The flat underside of a scan that ends inside the face: it looks down where a face never does.
bool is_cut(const Place& p, double normal_up) {
  return normal_up < -0.9 && p.y > lower_border(p.z) + 15 && !is_ear(p) && !is_nose(p) &&
         !is_eye(p);
}

SkinRegion region_at(const Place& p, double normal_up) {
  if (is_cut(p, normal_up)) return SkinRegion::other;
  if (is_ear(p)) return SkinRegion::ear;
  if (is_neck(p)) return SkinRegion::neck;
  if (is_nose(p)) return SkinRegion::nose;
  if (is_eye(p)) return SkinRegion::eye;
  if (is_lips(p)) return SkinRegion::lips;
  if (is_chin(p)) return SkinRegion::chin;
  if (is_brow(p)) return SkinRegion::eyebrow;
  if (is_forehead(p)) return SkinRegion::forehead;
  if (is_cheekbone(p)) return SkinRegion::cheekbone;
  if (is_cranium(p)) return SkinRegion::cranium;
  if (is_cheek(p)) return SkinRegion::cheek;
  if (is_jaw(p)) return SkinRegion::jaw;
  return SkinRegion::other;
}

}  // namespace

std::vector<SkinRegion> skin_regions(const std::vector<Vec3>& points,
                                     const std::vector<Vec3>& normals,
                                     const LandmarkSet& landmarks) {
  if (normals.size() != points.size()) {
    throw InputError(
        fmt::format("skin regions: {} normals for {} points", normals.size(), points.size()));
  }
  const FaceWarp warp(landmarks);
  std::vector<SkinRegion> regions;
  regions.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = warp.to_mean(points[i]);
    regions.push_back(region_at({std::abs(p.x()), p.y(), p.z()}, normals[i].y()));
  }
  return regions;
}

}  // namespace palpate::landmarks
