// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "report/figures_of_map.hpp"
#include "surface/point_tree.hpp"

namespace palpate::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSamePlace = 1e-3;   // [mm] of vertices that are the same
constexpr double kLeastPaired = 0.5;  // [-] of the vertices must find a partner

std::vector<Vec3> places_mm(const TouchableHead& head) {
  std::vector<Vec3> p = head.skin.points;
  for (Vec3& x : p) x *= head.unit_mm;
  return p;
}

/// Per vertex of `a` its partner in `b`, or -1.
std::vector<std::int32_t> partners(const std::vector<Vec3>& a, const std::vector<Vec3>& b,
                                   double reach) {
  std::vector<std::int32_t> of(a.size(), -1);
  bool same = a.size() == b.size();
  for (std::size_t v = 0; same && v < a.size(); ++v) same = (a[v] - b[v]).norm() <= kSamePlace;
  if (same) {
    for (std::size_t v = 0; v < a.size(); ++v) of[v] = static_cast<std::int32_t>(v);
    return of;
  }
  const surface::PointTree tree(b);
  std::vector<surface::PointTree::Neighbour> found;
  for (std::size_t v = 0; v < a.size(); ++v) {
    tree.nearest(a[v], 1, found);
    if (!found.empty() && found[0].distance2 <= reach * reach) of[v] = found[0].point;
  }
  return of;
}

bool inside(const Box& box, const Vec3& p) {
  return ((p - box.low).array() >= 0).all() && ((box.high - p).array() >= 0).all();
}

bool on_face(SkinRegion r) {
  return r != SkinRegion::cranium &&
         std::find(kPublishedOrder.begin(), kPublishedOrder.end(), r) != kPublishedOrder.end();
}

double mean(const std::vector<double>& x) {
  double sum = 0;
  std::size_t n = 0;
  for (const double v : x)
    if (std::isfinite(v)) sum += v, ++n;
  return n ? sum / static_cast<double>(n) : kNan;
}

std::vector<double> sizes(std::vector<double> x) {
  for (double& v : x) v = std::abs(v);
  return x;
}

/// Figures over some vertices.
RegionComparison figures(SkinRegion region, const std::vector<std::size_t>& vertices,
                         const Comparison& c, const MapSpread& spread) {
  std::vector<double> depth, stiffness, inside_two, sd;
  for (const std::size_t v : vertices) {
    stiffness.push_back(c.stiffness[v]);
    if (!std::isfinite(c.depth[v])) continue;
    depth.push_back(c.depth[v]);
    if (spread.empty() || !std::isfinite(spread.depth[v])) continue;
    sd.push_back(spread.depth[v]);
    inside_two.push_back(std::abs(c.depth[v]) <= 2 * spread.depth[v] ? 1.0 : 0.0);
  }
  return {
      region,           depth.size(), mean(sizes(depth)), median(depth), median(sizes(stiffness)),
      mean(inside_two), mean(sd)};
}

}  // namespace

Comparison compare_heads(const TouchableHead& estimated, const TouchableHead& known,
                         const ComparisonOptions& options) {
  const std::vector<Vec3> here = places_mm(estimated), there = places_mm(known);
  const std::vector<std::int32_t> partner = partners(here, there, options.reach);
  const auto paired =
      std::count_if(partner.begin(), partner.end(), [](std::int32_t p) { return p >= 0; });
  if (static_cast<double>(paired) < kLeastPaired * static_cast<double>(here.size()))
    throw InputError(fmt::format(
        "compare: only {} of {} vertices have one of the other head within {} mm; both must be "
        "built from the same scan, in its own frame",
        paired, here.size(), options.reach));

  Comparison c{std::vector<double>(here.size(), kNan),
               std::vector<double>(here.size(), kNan),
               {},
               kNan,
               {},
               kNan,
               kNan};
  std::vector<double> face_error, face_truth;
  std::array<std::vector<std::size_t>, kSkinRegionNames.size()> members;
  std::vector<std::size_t> everywhere;
  for (std::size_t v = 0; v < here.size(); ++v) {
    const std::int32_t p = partner[v];
    if (p < 0) continue;
    if (std::any_of(options.leave_out.begin(), options.leave_out.end(),
                    [&](const Box& box) { return inside(box, here[v]); }))
      continue;
    const double a = estimated.map.depth[v], b = known.map.depth[p];
    if (a <= options.deepest && b <= options.deepest) c.depth[v] = a - b;  // false for NaN
    c.stiffness[v] = compared_stiffness(estimated.map, v) / compared_stiffness(known.map, p) - 1;
    if (!std::isfinite(c.depth[v])) c.stiffness[v] = kNan;
    const SkinRegion region = estimated.map.region[v];
    members[static_cast<std::size_t>(region)].push_back(v);
    everywhere.push_back(v);
    if (!on_face(region) || !std::isfinite(c.depth[v])) continue;
    face_error.push_back(std::abs(c.depth[v]));
    face_truth.push_back(b);
  }
  c.all = figures(SkinRegion::other, everywhere, c, estimated.spread);
  c.depth_p95 = quantile(sizes(c.depth), 0.95);
  for (std::size_t r = 0; r < members.size(); ++r)
    if (!members[r].empty())
      c.regions.push_back(figures(static_cast<SkinRegion>(r), members[r], c, estimated.spread));
  c.face_error = mean(face_error);
  const double best = median(face_truth);
  for (double& d : face_truth) d = std::abs(d - best);
  c.face_constant_error = mean(face_truth);
  return c;
}

nlohmann::json to_json(const Comparison& c) {
  using nlohmann::json;
  const auto number = [](double x) { return std::isfinite(x) ? json(x) : json(nullptr); };
  const auto row = [&](const RegionComparison& r) {
    return json{{"vertices", r.vertices},
                {"depth_error_mean_mm", number(r.depth_error)},
                {"depth_bias_median_mm", number(r.depth_bias)},
                {"stiffness_error_median", number(r.stiffness_error)},
                {"within_2_sd", number(r.within_two_sd)},
                {"sd_mean_mm", number(r.stated_sd)}};
  };
  json regions = json::array();
  for (const RegionComparison& r : c.regions) {
    json one = row(r);
    one["region"] = std::string(name(r.region));
    regions.push_back(one);
  }
  json depth = row(c.all);
  depth.erase("stiffness_error_median");
  depth["error_p95_mm"] = number(c.depth_p95);
  depth["face_error_mean_mm"] = number(c.face_error);
  depth["face_constant_error_mean_mm"] = number(c.face_constant_error);
  return {{"depth", depth},
          {"stiffness", {{"error_median", number(c.all.stiffness_error)}}},
          {"regions", regions}};
}

}  // namespace palpate::report
