// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "registration/place.hpp"
#include "skull/depth_fit.hpp"
#include "skull/depth_model.hpp"
#include "skull/depth_terms.hpp"
#include "skull/published.hpp"
#include "skull/skin_field.hpp"

namespace palpate::skull {
namespace {

void set_statistics(SkullFit& fit, const SkinField& skin, double clearance) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t outside = 0, close = 0;
  for (const Vec3& p : fit.mesh.points) {
    const double depth = skin.depth(p);
    least = std::min(least, depth);
    outside += depth < 0;
    close += depth < clearance;
  }
  fit.statistics["vertex_count"] = static_cast<double>(fit.mesh.points.size());
  fit.statistics["outside_count"] = static_cast<double>(outside);
  fit.statistics["below_clearance_count"] = static_cast<double>(close);
  fit.statistics["min_clearance_mm"] = least;
}

void set_depths(SkullFit& fit, const SkinField& skin, const std::vector<TissueDepth>& table) {
  double sum = 0, squares = 0;
  int rows = 0, within = 0, with_sd = 0;
  for (const auto& [code, landmark] : fit.landmarks) {
    const TissueDepth* published = find_depth(table, code);
    if (!published) continue;
    const SkinDepth found = skin.at(landmark.position);
    DepthRow row{code, published->mean_mm, published->sd_mm, found.depth, found.known};
    if (!row.reached) row.depth_mm = std::numeric_limits<double>::quiet_NaN();
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

SkullFit fit_depth(const HeadSurface& head, const SkullTemplate& skull, const SkinField& skin,
                   const std::vector<TissueDepth>& table, const FitOptions& options,
                   const Progress& progress) {
  const registration::Placement start = registration::place_similarity(head, skull);
  const DepthModel model = make_depth_model(skull, table);
  const std::vector<FitPoint> points = make_fit_points(head, skull, model, options);
  const DepthFit solved = solve_depth_fit(skull, points, skin, start, options, progress);
  SkullFit fit;
  fit.mesh = skull.mesh;
  for (Vec3& p : fit.mesh.points) p = solved.map(p);
  fit.region = skull.region;
  for (const auto& [code, landmark] : skull.landmarks)
    fit.landmarks[code] = {
        solved.map(landmark.position),
        (solved.map.gradient(landmark.position).inverse().transpose() * landmark.normal)
            .stableNormalized()};
  fit.statistics["placement_rms_mm"] = start.rms_mm;
  fit.statistics["iterations"] = solved.iterations;
  fit.statistics["energy"] = solved.energy;
  fit.statistics["bending_per_mm"] = solved.bending_used;
  fit.statistics["least_jacobian"] = solved.least_jacobian;
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
  set_depths(fit, skin, depths);
  return fit;
}

}  // namespace palpate::skull
