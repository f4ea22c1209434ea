// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/depth_terms.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "registration/place.hpp"

namespace palpate::skull {
namespace {

/// Skin landmarks that bound a bone landmark along some axes of the head frame. The auricle's
/// centre lies beside the ear canal: it says how high and how far back the porion is. The chin's
/// foremost point says how high the bone's is; how deep, the table says.
struct AxisPair {
  const char* skin;
  const char* bone;
  Vec3 axes;
  double DepthFitOptions::*sd;
};
const std::array<AxisPair, 3> kAxisPairs = {
    {{"ear_left", "po_left", {0, 1, 1}, &DepthFitOptions::ear_sd},
     {"ear_right", "po_right", {0, 1, 1}, &DepthFitOptions::ear_sd},
     {"chin", "pg", {0, 1, 0}, &DepthFitOptions::chin_sd}}};

FitPoint registration_point(const Vec3& rest, const Landmark& target, const Vec3& axes, double sd) {
  FitPoint p;
  p.kind = FitPoint::Kind::registration;
  p.rest = rest;
  p.target = target.position;
  p.precision = std::clamp(target.confidence, 0.0, 1.0) / (sd * sd) * axes;
  return p;
}

/// Landmarks of the chin's lower border. Their depth is measured along the bone's normal, as a
/// probe measures it: the shortest way out of a jaw that lies too high leads through the lips and
/// says nothing of how far the chin is.
constexpr std::array<const char*, 2> kBorder = {"gn", "me"};
/// [mm] how far their skin is looked for, and the least cosine of the way to the skin's normal.
constexpr double kBorderReach = 60;
constexpr double kBorderFacing = 0.4;

/// Depth of a landmark of the border and where it grows fastest; nothing where the way out meets no
/// scanned skin, or grazes it.
std::optional<SkinDepth> border_depth(const Vec3& p, const Vec3& outward, const SkinField& skin) {
  if (outward.isZero()) return std::nullopt;
  const auto exit = skin.exit(p, outward, kBorderReach);
  if (!exit || exit->normal.dot(outward) < kBorderFacing) return std::nullopt;
  SkinDepth d;
  d.depth = exit->length;
  d.gradient = -exit->normal / exit->normal.dot(outward);
  d.known = true;
  return d;
}

using Cell = std::array<int, 3>;

Cell cell_of(const Vec3& p, double size) {
  // Mirrored cells are mirror images: x counts away from the midplane on both sides.
  const int away = static_cast<int>(std::floor(std::abs(p.x()) / size));
  return {p.x() < 0 ? -1 - away : away, static_cast<int>(std::floor(p.y() / size)),
          static_cast<int>(std::floor(p.z() / size))};
}

Vec3 center_of(const Cell& c, double size) {
  return Vec3((c[0] + 0.5) * size, (c[1] + 0.5) * size, (c[2] + 0.5) * size);
}

struct Representative {
  std::size_t vertex = 0;
  double distance2 = 1e300;
  double seen_area = 0;
};

/// One vertex per grid cell and side of the bone, standing for the cell's area.
std::vector<Representative> representatives(const SkullTemplate& skull, const DepthModel& model,
                                            double size) {
  std::map<std::pair<Cell, int>, Representative> chosen;
  for (std::size_t i = 0; i < skull.mesh.points.size(); ++i) {
    const Vec3& p = skull.mesh.points[i];
    const Cell cell = cell_of(p, size);
    // Seen and hidden bone of one cell (a thin plate's two faces) are kept apart.
    Representative& r = chosen[{cell, model.area[i] > 0 ? 1 : 0}];
    r.seen_area += model.area[i];
    const double d2 = (p - center_of(cell, size)).squaredNorm();
    if (d2 < r.distance2) {
      r.distance2 = d2;
      r.vertex = i;
    }
  }
  std::vector<Representative> list;
  for (const auto& [cell, r] : chosen) list.push_back(r);
  return list;
}

}  // namespace

std::vector<FitPoint> make_fit_points(const HeadSurface& head, const SkullTemplate& skull,
                                      const DepthModel& model, const FitOptions& options) {
  const DepthFitOptions& o = options.depth;
  const std::vector<Vec3> normals = vertex_normals(skull.mesh);
  std::vector<FitPoint> points;
  for (const Representative& r : representatives(skull, model, o.sampling)) {
    const bool floor_of_orbit = skull.region[r.vertex] == SkullRegion::orbit;
    FitPoint p;
    p.rest = skull.mesh.points[r.vertex];
    p.normal = normals[r.vertex];
    p.mean = model.mean[r.vertex];
    p.sd = model.sd[r.vertex];
    p.weight = floor_of_orbit ? 0 : r.seen_area / o.patch_area;
    p.limit_weight = o.sampling * o.sampling / o.limit_area;
    points.push_back(p);
  }
  for (const LandmarkTarget& l : model.landmarks) {
    FitPoint p;
    p.kind = FitPoint::Kind::landmark;
    p.rest = l.position;
    p.mean = l.mean;
    p.sd = l.sd;
    p.weight = o.landmark_weight;
    if (std::find(kBorder.begin(), kBorder.end(), l.code) != kBorder.end())
      p.normal = skull.landmarks.at(l.code).normal;
    points.push_back(p);
  }
  for (const registration::PointPair& pair : registration::shared_pairs(head, skull))
    points.push_back(registration_point(pair.from, head.landmarks.at(pair.name), Vec3::Ones(),
                                        o.registration_sd));
  for (const AxisPair& pair : kAxisPairs) {
    const auto on_head = head.landmarks.find(pair.skin);
    const auto on_skull = skull.landmarks.find(pair.bone);
    if (on_head != head.landmarks.end() && on_skull != skull.landmarks.end())
      points.push_back(
          registration_point(on_skull->second.position, on_head->second, pair.axes, o.*pair.sd));
  }
  return points;
}

Standing standing(const std::vector<FitPoint>& points, const std::vector<Vec3>& positions,
                  const std::vector<Vec3>& normals, const SkinField& skin,
                  const FitOptions& options) {
  Standing s{std::vector<std::uint8_t>(points.size(), 0),
             std::vector<std::uint8_t>(points.size(), 0),
             std::vector<Vec3>(points.size(), Vec3::Zero())};
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (points[i].kind == FitPoint::Kind::registration) return;
    if (points[i].kind == FitPoint::Kind::landmark && skin.depth(positions[i]) > 0 &&
        border_depth(positions[i], normals[i], skin)) {
      s.outward[i] = normals[i];
      s.drawn[i] = 1;
      return;
    }
    const SkinDepth d = skin.at(positions[i]);
    const bool facing = points[i].kind == FitPoint::Kind::landmark ||
                        normals[i].dot(-d.gradient) > options.depth.facing;
    s.drawn[i] = (d.known || d.completed) && facing && points[i].weight > 0;
    s.limited[i] = !d.open && points[i].limit_weight > 0;
  });
  return s;
}

Linearisation linearise(const std::vector<FitPoint>& points, const std::vector<Vec3>& positions,
                        const Standing& standing, const SkinField& skin,
                        const FitOptions& options) {
  const DepthFitOptions& o = options.depth;
  const double limit = options.clearance + o.limit_margin;
  const double limit_stiffness = 1 / (o.limit_sd * o.limit_sd);
  std::vector<SkinDepth> depth(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (!standing.drawn[i] && !standing.limited[i]) return;
    const auto along = border_depth(positions[i], standing.outward[i], skin);
    depth[i] = along ? *along : skin.at(positions[i]);
  });
  Linearisation out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FitPoint& p = points[i];
    const auto index = static_cast<std::int32_t>(i);
    if (p.kind == FitPoint::Kind::registration) {
      const Vec3 left = p.target - positions[i];
      out.energy += 0.5 * left.cwiseAbs2().dot(p.precision);
      for (int a = 0; a < 3; ++a)
        if (p.precision[a] > 0) out.rows.push_back({index, Vec3::Unit(a), left[a], p.precision[a]});
      continue;
    }
    if (!standing.drawn[i] && !standing.limited[i]) continue;
    const SkinDepth& d = depth[i];
    if (standing.drawn[i]) {
      const double sd = d.completed ? std::hypot(p.sd, o.completed_sd) : p.sd;
      const double r = std::abs(d.depth - p.mean) / sd;
      const double damping = r > o.huber ? o.huber / r : 1.0;
      out.energy += p.weight * (r > o.huber ? o.huber * (r - 0.5 * o.huber) : 0.5 * r * r);
      out.rows.push_back({index, d.gradient, p.mean - d.depth, p.weight * damping / (sd * sd)});
    }
    if (standing.limited[i] && d.depth < limit) {
      const double weight = p.limit_weight * limit_stiffness;
      out.energy += 0.5 * weight * (limit - d.depth) * (limit - d.depth);
      out.rows.push_back({index, d.gradient, limit - d.depth, weight});
    }
  }
  return out;
}

}  // namespace palpate::skull
