// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/fit.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "core/error.hpp"
#include "registration/place.hpp"
#include "skull/clearance.hpp"
#include "skull/clip.hpp"
#include "skull/depth_fit.hpp"
#include "skull/depth_model.hpp"
#include "skull/depth_terms.hpp"
#include "skull/published.hpp"
#include "skull/skin_field.hpp"
#include "skull/spread.hpp"

namespace palpate::skull {
namespace {

constexpr double kClipMargin = 0.2;  ///< [mm] cut faces keep this beyond the clearance
constexpr double kOpenShare = 0.8;   ///< [-] of the bone behind a plane that must lack skin
constexpr double kCutEdge = 3.0;     ///< [mm] triangles of a cut face: the template's own

void set_statistics(SkullFit& fit, const SkinField& skin, double clearance) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t outside = 0, close = 0;
  std::vector<double> depths(fit.mesh.points.size());
  tbb::parallel_for(std::size_t{0}, depths.size(),
                    [&](std::size_t i) { depths[i] = skin.depth(fit.mesh.points[i]); });
  for (const double depth : depths) {
    least = std::min(least, depth);
    outside += depth < 0;
    close += depth < clearance;
  }
  fit.statistics["vertex_count"] = static_cast<double>(fit.mesh.points.size());
  fit.statistics["outside_count"] = static_cast<double>(outside);
  fit.statistics["below_clearance_count"] = static_cast<double>(close);
  fit.statistics["min_clearance_mm"] = least;
}

void set_depths(SkullFit& fit, const SkullTemplate& skull, const SkinField& skin,
                const std::vector<TissueDepth>& table) {
  double sum = 0, squares = 0;
  int rows = 0, within = 0, with_sd = 0;
  for (const auto& [code, on_template] : skull.landmarks) {
    const TissueDepth* published = find_depth(table, code);
    if (!published) continue;
    DepthRow row{code, published->mean_mm, published->sd_mm,
                 std::numeric_limits<double>::quiet_NaN(), false};
    if (const auto at = fit.landmarks.find(code); at != fit.landmarks.end()) {
      const SkinDepth found = skin.at(at->second.position);
      row.reached = found.known;
      if (found.known) row.depth_mm = found.depth;
    }
    fit.depths.push_back(row);
    if (!row.reached) continue;
    const double misfit = row.depth_mm - row.published_mm;
    ++rows;
    sum += misfit;
    squares += misfit * misfit;
    if (row.sd_mm <= 0) continue;
    ++with_sd;
    within += std::abs(misfit) <= 1.5 * row.sd_mm;
  }
  if (rows == 0) return;
  const double mean = sum / rows;
  fit.statistics["depth_residual_mean_mm"] = mean;
  fit.statistics["depth_residual_sd_mm"] = std::sqrt(std::max(0.0, squares / rows - mean * mean));
  fit.statistics["depth_rows_reached"] = rows;
  if (with_sd > 0) fit.statistics["depth_rows_within_1.5_sd"] = double(within) / with_sd;
}

/// Planes behind which bone really is missing skin: most of what lies there is outside, or under a
/// cap. A cap's plane also runs through places that the scan shows; bone there stays.
std::vector<registration::CutPlane> planes_to_clip(const SkullFit& fit, const SkinField& skin,
                                                   const FitOptions& options) {
  std::vector<registration::CutPlane> planes;
  for (registration::CutPlane plane : skin.ends().planes) {
    plane.offset -= options.clearance + kClipMargin;
    std::size_t behind = 0, open = 0;
    for (const Vec3& p : fit.mesh.points) {
      if (plane.normal.dot(p) <= plane.offset) continue;
      ++behind;
      open += skin.at(p).open;
    }
    if (behind > 0 && open >= kOpenShare * behind) planes.push_back(plane);
  }
  return planes;
}

/// Carries the spread to the points that a cut left. Draws hold offsets until place_draws.
void keep_only(SkullFit& fit, const std::vector<std::int32_t>& origin) {
  const auto kept = [&](const auto& all) {
    std::remove_cvref_t<decltype(all)> some;
    for (const std::int32_t i : origin) some.push_back(all[i]);
    return some;
  };
  fit.spread = kept(fit.spread);
  for (auto& draw : fit.draws) draw = kept(draw);
}

/// Offsets to places, after the skull itself has come to rest.
void place_draws(SkullFit& fit) {
  for (auto& draw : fit.draws)
    for (std::size_t v = 0; v < draw.size(); ++v) draw[v] += fit.mesh.points[v];
  double sum = 0;
  for (const double s : fit.spread) sum += s;
  fit.statistics["spread_draws"] = static_cast<double>(fit.draws.size());
  fit.statistics["spread_mean_mm"] = sum / static_cast<double>(fit.spread.size());
}

void clip_at_scan_ends(SkullFit& fit, const SkinField& skin, const FitOptions& options) {
  const std::vector<registration::CutPlane> planes = planes_to_clip(fit, skin, options);
  fit.statistics["clipped_mm3"] = 0;
  if (planes.empty()) return;
  Clipped clipped = clip_closed(fit.mesh, planes, kCutEdge);
  fit.mesh = std::move(clipped.mesh);
  std::vector<SkullRegion> region;
  for (const std::int32_t i : clipped.origin) region.push_back(fit.region[i]);
  fit.region = std::move(region);
  keep_only(fit, clipped.origin);
  for (const registration::CutPlane& plane : planes)
    std::erase_if(fit.landmarks, [&](const auto& entry) {
      return plane.normal.dot(entry.second.position) > plane.offset;
    });
  fit.statistics["clipped_mm3"] = clipped.removed_mm3;
  fit.warnings.push_back(fmt::format(
      "the scan ends before the skull does: {:.0f} cm^3 of bone beyond its {} were cut off",
      clipped.removed_mm3 / 1000, planes.size() == 1 ? "end" : "ends"));
}

void clear_the_skin(SkullFit& fit, const SkinField& skin, const FitOptions& options,
                    const Progress& progress) {
  std::vector<Vec3> riders;
  for (const auto& [code, landmark] : fit.landmarks) riders.push_back(landmark.position);
  ClearanceOptions clear;
  clear.clearance = options.clearance;
  const ClearanceReport report = keep_clear(fit.mesh.points, riders, skin, clear, progress);
  std::size_t i = 0;
  for (auto& [code, landmark] : fit.landmarks) landmark.position = riders[i++];
  fit.statistics["pushed_count"] = static_cast<double>(report.pushed);
  fit.statistics["largest_push_mm"] = report.largest_push;
  if (report.remaining > 0)
    throw SolveError(
        fmt::format("{} points of the skull could not be kept {} mm under the skin; check the "
                    "landmarks, or lower the clearance",
                    report.remaining, options.clearance),
        static_cast<double>(report.remaining));
}

/// How the jaw stands, with the doubt of that; nothing where the template's has no pose.
void set_pose(SkullFit& fit, const DepthFit& solved) {
  if (!solved.map.jaw.present) return;
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Eigen::Index n = solved.information.rows();
  const Eigen::VectorXd column = solved.information.llt().solve(Eigen::VectorXd::Unit(n, n - 3));
  fit.statistics["jaw_opening_deg"] = kDegrees * solved.map.pose.opening;
  fit.statistics["jaw_opening_sd_deg"] = kDegrees * std::sqrt(column[n - 3]);
  fit.statistics["jaw_advance_mm"] = solved.map.pose.advance;
  fit.statistics["jaw_shift_mm"] = solved.map.pose.shift;
}

/// No bone between the teeth of an open mouth, where the template lets itself be cut.
void leave_the_mouth_free(SkullTemplate& skull, DepthFit& solved,
                          std::vector<std::string>& warnings) {
  try {
    PartedTeeth parted = part_teeth(skull, solved.map.jaw);
    skull = std::move(parted.skull);
    solved.map.jaw = parted.jaw;
  } catch (const SolveError& e) {
    warnings.push_back(
        fmt::format("the mouth is open, but bone is left between the teeth: {}", e.what()));
  }
}

SkullFit fit_depth(const HeadSurface& head, SkullTemplate skull, const SkinField& skin,
                   const std::vector<TissueDepth>& table, const FitOptions& options,
                   const Progress& progress) {
  const registration::Placement start = registration::place_similarity(head, skull);
  DepthModel model = make_depth_model(skull, table);
  const std::vector<FitPoint> points = make_fit_points(head, skull, model, options);
  DepthFit solved =
      solve_depth_fit(skull, points, skin, start, head.mouth_opening, options, progress);
  SkullFit fit;
  if (solved.mouth_open) {
    leave_the_mouth_free(skull, solved, fit.warnings);
    model = make_depth_model(skull, table);
  }
  fit.mesh = skull.mesh;
  for (Vec3& p : fit.mesh.points) p = solved.map(p);
  SpreadOptions doubt;
  doubt.completed_sd = options.depth.completed_sd;
  SkullSpread spread = draw_spread(skull, fit.mesh.points, solved, model, skin, doubt);
  fit.spread = std::move(spread.deviation);
  fit.draws = std::move(spread.offset);
  fit.region = skull.region;
  for (const auto& [code, landmark] : skull.landmarks)
    fit.landmarks[code] = {
        solved.map(landmark.position),
        (solved.map.gradient(landmark.position).inverse().transpose() * landmark.normal)
            .stableNormalized()};
  clip_at_scan_ends(fit, skin, options);
  clear_the_skin(fit, skin, options, progress);
  place_draws(fit);
  fit.statistics["self_intersections"] = double(count_self_intersections(fit.mesh));
  fit.statistics["placement_rms_mm"] = start.rms_mm;
  fit.statistics["iterations"] = solved.iterations;
  fit.statistics["energy"] = solved.energy;
  fit.statistics["bending_per_mm"] = solved.bending_used;
  fit.statistics["least_jacobian"] = solved.least_jacobian;
  set_pose(fit, solved);
  return fit;
}

}  // namespace

SkullFit fit_skull(const HeadSurface& head, const SkullTemplate& skull,
                   const std::vector<TissueDepth>& depths, const FitOptions& options,
                   const Progress& progress) {
  const SkinField skin(head);
  SkullFit fit = options.method == Method::published
                     ? fit_published(head, skull, options, progress)
                     : fit_depth(head, skull, skin, depths, options, progress);
  set_statistics(fit, skin, options.clearance);
  set_depths(fit, skull, skin, depths);
  if (options.method == Method::published && fit.statistics["below_clearance_count"] > 0)
    fit.warnings.push_back(fmt::format(
        "the published fit has no target depth: {:.0f} % of the skull lie outside the skin and "
        "{:.0f} % are closer to it than {} mm; use the default fit for anything but comparison",
        100 * fit.statistics["outside_count"] / fit.statistics["vertex_count"],
        100 * fit.statistics["below_clearance_count"] / fit.statistics["vertex_count"],
        options.clearance));
  return fit;
}

}  // namespace palpate::skull
