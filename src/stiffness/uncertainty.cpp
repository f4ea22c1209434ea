// SPDX-License-Identifier: GPL-3.0-or-later
// Bonded layer. With x = a/h (contact radius over depth), chi = delta R / a^2 and
// kappa = P (1 - nu^2) / (2 a E delta) are functions of x alone, so that
//   delta = chi x^2 h^2 / R,      P = 2 E / (1 - nu^2) * kappa chi x^3 h^3 / R.
// At fixed P, with ' for d ln / d ln x:  d ln x = -(3 d ln h + d ln E) / (3 + chi' + kappa'), and
// d ln k = -d ln delta = -(2 + chi') d ln x - 2 d ln h.
// Limits: deep tissue (x -> 0) chi = 1, kappa = 2/3, both flat: Hertz, k ~ E^(2/3), free of h.
#include "stiffness/uncertainty.hpp"
#include "core/organs.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "stiffness/press_sites.hpp"
#include "stiffness/site_features.hpp"
#include "surface/point_tree.hpp"
#include "surface/query.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kOffSkin = 4;  // [mm] a point farther from the working skin is not skin

/// x, chi, kappa at nu = 0.43.
constexpr std::array<std::array<double, 3>, 14> kLayer = {{{0.1, 0.93375, 0.71445},
                                                           {0.2, 0.87153, 0.76887},
                                                           {0.3, 0.81589, 0.83053},
                                                           {0.4, 0.76781, 0.89984},
                                                           {0.5, 0.72716, 0.97694},
                                                           {0.6, 0.69321, 1.06171},
                                                           {0.8, 0.64152, 1.25263},
                                                           {1.0, 0.60540, 1.46818},
                                                           {1.5, 0.55225, 2.08613},
                                                           {2.0, 0.52442, 2.78254},
                                                           {3.0, 0.49777, 4.32735},
                                                           {4.0, 0.48681, 6.00083},
                                                           {6.0, 0.48036, 9.53562},
                                                           {8.0, 0.48019, 13.16801}}};

constexpr double kNodeStep = 0.1;      // [-] of ln depth, between nodes of the response
constexpr double kWindow = 0.3;        // [-] of ln depth, over which its slope is taken
constexpr double kLeastVertices = 50;  // [-] weight of vertices that a slope needs
constexpr double kSteepest = -2;       // [-] no layer answers more

/// Travel of the tool at `force`, linear between the samples; NaN beyond them.
double travel_at(const StiffnessMap& map, std::size_t v, double force) {
  const auto curve = map.curve(v);
  double f0 = 0, u0 = 0;
  for (std::size_t i = 0; i < map.forces.size(); ++i) {
    if (map.forces[i] >= force - 1e-9)
      return u0 + (curve[i] - u0) * (force - f0) / (map.forces[i] - f0);
    f0 = map.forces[i], u0 = curve[i];
  }
  return kNan;
}

/// Along the inward normal, at the points of the working skin; NaN where the fit has no bone.
std::vector<double> depth_spread(const HeadSurface& head, const SkullFit& skull, double tool_radius,
                                 const SpreadOptions& options, const Progress& progress) {
  const std::vector<Vec3> normal = smoothed_normals(head.skin, tool_radius);
  const std::size_t n = normal.size();
  const auto depths = [&](const std::vector<Vec3>& places) {
    const surface::SurfaceQuery bone({places, skull.mesh.triangles});
    std::vector<double> depth(n, options.no_bone_beyond);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) {
      if (const auto hit = bone.cast(head.skin.points[v], -normal[v], options.no_bone_beyond))
        depth[v] = hit->distance;
    });
    return depth;
  };
  const std::vector<double> here = depths(skull.mesh.points);
  std::vector<double> spread(n, 0.0);
  for (std::size_t k = 0; k < skull.draws.size(); ++k) {
    progress.step("spread", static_cast<double>(k) / static_cast<double>(skull.draws.size()));
    const std::vector<double> there = depths(skull.draws[k]);
    for (std::size_t v = 0; v < n; ++v) spread[v] += std::pow(there[v] - here[v], 2);
  }
  for (std::size_t v = 0; v < n; ++v)
    spread[v] = here[v] < options.no_bone_beyond
                    ? std::sqrt(spread[v] /
                                static_cast<double>(std::max<std::size_t>(1, skull.draws.size())))
                    : kNan;
  return spread;
}

}  // namespace

LayerSensitivity layer_sensitivity(double travel, double depth, double tool_radius) {
  // chi x^2 grows with x: the row between two nodes in which it takes the wanted value.
  const double wanted = travel * tool_radius / (depth * depth);
  const auto value = [](const std::array<double, 3>& row) { return row[1] * row[0] * row[0]; };
  if (wanted <= 0.25 * value(kLayer.front())) return {0, 2.0 / 3};
  std::size_t i = 1;
  while (i + 1 < kLayer.size() && value(kLayer[i]) < wanted) ++i;
  const auto &a = kLayer[i - 1], &b = kLayer[i];
  const double step = std::log(b[0] / a[0]);
  const double chi = std::log(b[1] / a[1]) / step, kappa = std::log(b[2] / a[2]) / step;
  const double all = 3 + chi + kappa;
  return {3 * (2 + chi) / all - 2, (2 + chi) / all};
}

DepthResponse::DepthResponse(const std::vector<double>& depth,
                             const std::vector<double>& stiffness) {
  std::vector<std::array<double, 2>> pairs;  // ln depth, ln k
  for (std::size_t v = 0; v < depth.size(); ++v)
    if (depth[v] > 0 && stiffness[v] > 0 && std::isfinite(depth[v]) && std::isfinite(stiffness[v]))
      pairs.push_back({std::log(depth[v]), std::log(stiffness[v])});
  if (pairs.empty()) return;
  const auto [low, high] = std::minmax_element(pairs.begin(), pairs.end());
  first_ = (*low)[0];
  const int nodes = 1 + static_cast<int>(std::ceil(((*high)[0] - first_) / kNodeStep));
  for (int n = 0; n < nodes; ++n) {
    const double middle = first_ + kNodeStep * n;
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& [d, k] : pairs) {
      const double away = (d - middle) / kWindow;
      if (std::abs(away) > 3) continue;
      const double weight = std::exp(-0.5 * away * away);
      w += weight, x += weight * d, y += weight * k, xx += weight * d * d, xy += weight * d * k;
    }
    const double spread = xx / w - x / w * (x / w);
    const bool enough = w >= kLeastVertices && spread > 0.1 * kWindow * kWindow;
    slope_.push_back(enough ? std::clamp((xy / w - x / w * (y / w)) / spread, kSteepest, 0.0)
                            : kNan);
  }
}

double DepthResponse::at(double depth, double otherwise) const {
  if (slope_.empty() || !(depth > 0)) return otherwise;
  const double place = std::clamp((std::log(depth) - first_) / kNodeStep, 0.0,
                                  static_cast<double>(slope_.size() - 1));
  const auto node = static_cast<std::size_t>(std::lround(place));
  return std::isfinite(slope_[node]) ? slope_[node] : otherwise;
}

MapSpread map_spread(const StiffnessMap& map, const HeadSurface& head, const SkullFit& skull,
                     const std::vector<Vec3>& points, const SpreadOptions& options,
                     const Progress& progress) {
  const std::vector<double> on_skin = depth_spread(head, skull, map.tool_radius, options, progress);
  std::vector<double> stiffness(points.size(), kNan);
  for (std::size_t p = 0; p < points.size(); ++p)
    if (map.has_curve(p)) stiffness[p] = options.force / travel_at(map, p, options.force);
  const auto on_organ = [&](std::size_t p) {
    return map.has_curve(p) && lies_on_organ(map.region[p]);
  };
  std::vector<double> on_bone = map.depth;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (on_organ(p)) on_bone[p] = kNan;
  const DepthResponse response(on_bone, stiffness);
  const surface::SurfaceQuery skin(head.skin);
  MapSpread out{std::vector<double>(points.size(), kNan), std::vector<double>(points.size(), kNan)};
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!std::isfinite(map.depth[p])) continue;
    const surface::ClosestPoint at = skin.closest(points[p], kOffSkin);
    if (at.triangle < 0) continue;
    double sum = 0, weights = 0;
    for (int i = 0; i < 3; ++i) {
      const double s = on_skin[head.skin.triangles[at.triangle][i]];
      const double w = std::max(0.0, at.barycentric[i]);
      if (std::isfinite(s)) sum += w * s, weights += w;
    }
    if (weights <= 1e-9) continue;
    out.depth[p] = on_organ(p) ? options.cover_sd : sum / weights;
    if (!map.has_curve(p)) continue;
    if (!(stiffness[p] > 0) || !(map.depth[p] > 0)) continue;
    const LayerSensitivity s =
        layer_sensitivity(options.force / stiffness[p], map.depth[p], map.tool_radius);
    const double to_depth = response.at(map.depth[p], s.to_depth);
    const double own = std::isfinite(map.error[p]) ? map.error[p] : 0;
    out.stiffness[p] = std::hypot(to_depth * out.depth[p] / map.depth[p],
                                  s.to_modulus * options.modulus_spread, own);
  }
  return out;
}

/// [mm] from the press axis to where the skin still moves.
static double felt_reach(const StiffnessMap& map, std::size_t p) {
  constexpr double kFelt = 0.02;  // [-] of the tool's travel that still counts as moving
  const std::size_t rings = map.dents.radii.size();
  if (rings == 0 || !map.has_curve(p)) {
    const double depth = std::isfinite(map.depth[p]) ? map.depth[p] : 1e9;
    return rule_for_depth(depth, map.tool_radius).touch_radius;
  }
  std::size_t last = 0;
  for (std::size_t r = 0; r < rings; ++r)
    if (map.dents.share[p * rings + r] >= kFelt) last = r;
  return map.dents.radii[std::min(last + 1, rings - 1)];
}

std::vector<std::uint8_t> rests_on_completed(const StiffnessMap& map, const HeadSurface& head,
                                             const std::vector<Vec3>& points) {
  std::vector<Vec3> completed;
  for (std::size_t v = 0; v < head.filled.size(); ++v)
    if (head.filled[v] == 2) completed.push_back(head.skin.points[v]);
  if (completed.empty()) return {};
  const surface::PointTree tree(completed);
  std::vector<surface::PointTree::Neighbour> nearest;
  std::vector<std::uint8_t> marked(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double reach = felt_reach(map, p);
    tree.nearest(points[p], 1, nearest);
    marked[p] = nearest[0].distance2 <= reach * reach;
  }
  return marked;
}

}  // namespace palpate::stiffness
