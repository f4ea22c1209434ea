// SPDX-License-Identifier: GPL-3.0-or-later
// What a skin point's surroundings look like to the tool: the ground on which curves are blended.
#pragma once
#include <optional>
#include <span>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "stiffness/patch.hpp"

namespace palpate::stiffness {

/// Unit normals averaged over the skin connected to each point within `radius` [mm], weights
/// area * (1 - (r/radius)^2)^2: remeshing noise does not tilt the press axis.
[[nodiscard]] std::vector<Vec3> smoothed_normals(const SurfaceMesh& skin, double radius);

/// The same average of a number per point.
[[nodiscard]] std::vector<double> smoothed_over_skin(const SurfaceMesh& skin,
                                                     std::span<const double> value, double radius);

/// Dimensionless numbers, comparable in size, invariant to a turn of the head.
struct SiteFeatures {
  double depth = 0;  ///< [mm] to the bone along the inward normal
  /// Per probe ring the mean of ln(thickness / R), the size of its first and second harmonic, the
  /// mean height times 2 R / r^2 (curvature) and the size of its second harmonic; first
  /// ln(depth/R).
  Eigen::VectorXd shape;
};
/// Radii of the probe rings as shares of the tool's radius.
inline constexpr std::array<double, 3> kProbeRings = {0.5, 1.1, 2.2};

/// Nothing where no bone lies within `limits.no_bone_beyond` along the inward normal.
[[nodiscard]] std::optional<SiteFeatures> site_features(const SiteFrame& frame, double tool_radius,
                                                        const surface::SurfaceQuery& skin,
                                                        const surface::SurfaceQuery& bone,
                                                        const SamplingLimits& limits);

/// Whether the way from the skin to the bone leaves the head on its way (an ear, a nostril, the
/// fold under a jaw): then there is no tissue between the two.
[[nodiscard]] bool leaves_tissue(const SiteFrame& frame, double depth,
                                 const surface::SurfaceQuery& skin);

}  // namespace palpate::stiffness
