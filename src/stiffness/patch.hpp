// SPDX-License-Identifier: GPL-3.0-or-later
// One site's tissue on the shared template: where skin and bone lie under each column.
#pragma once
#include <span>

#include "stiffness/patch_template.hpp"
#include "surface/query.hpp"

namespace palpate::stiffness {

/// The press axis and a tangent frame: columns of `axes` are e1, e2 and the outward normal.
struct SiteFrame {
  Vec3 origin = Vec3::Zero();    ///< [mm] on the skin
  Mat3 axes = Mat3::Identity();  ///< [-] proper rotation
  [[nodiscard]] Vec3 normal() const { return axes.col(2); }
};
/// e1 is the direction nearest to the head's +y (or +z where the normal is within 25 degrees of y).
[[nodiscard]] SiteFrame site_frame(const Vec3& origin, const Vec3& outward_normal);

/// Where on the working skin a column starts.
struct SkinSpot {
  std::int32_t triangle = -1;  ///< -1: nowhere, the column's top was bounded
  Vec3 barycentric = Vec3::Zero();
};
/// Skin and bone over the tangent plane, column by column.
struct PatchGeometry {
  std::vector<double> height;     ///< [mm] of the skin over the tangent plane, along the normal
  std::vector<double> thickness;  ///< [mm] > 0, from the skin down the inward normal to the bone
  /// Where each column's top lies; that of the inner neighbour where the skin was not seen.
  std::vector<SkinSpot> spot;
  int bent = 0;      ///< columns within the touch radius where the skin is no height field
  int bent_far = 0;  ///< the same beyond it
  int boneless = 0;  ///< columns without bone within reach; held at `no_bone_beyond`
};
struct SamplingLimits {
  double no_bone_beyond = 40;    ///< [mm] thickness where no bone is met
  double least_thickness = 1.0;  ///< [mm] where bone touches or leaves the skin
  double skin_slope = 1.5;       ///< [-] steepest skin (56 degrees) before it is cut off
  double bone_slope = 3.0;       ///< [-] steepest descent of the bone away from the site
};
/// Marches from the middle outwards: each column looks for the skin within the slope's reach of its
/// inner neighbour, so that a nose or an ear in the line of sight is not taken for the cheek below
/// it; where there is none, the slope's bound is used and counted in `bent`.
/// @param columns      of a template or of a coarser probe
/// @param near_radius  [mm] where `bent` is counted
[[nodiscard]] PatchGeometry sample_patch(std::span<const Column> columns, double near_radius,
                                         const SiteFrame& frame, const surface::SurfaceQuery& skin,
                                         const surface::SurfaceQuery& bone,
                                         const SamplingLimits& limits = {});

/// Rest positions [mm] in the site's frame (origin at the site, +z outward) of all nodes of the
/// quadratic mesh. Layers below the first thicken with depth where the tissue is thick.
/// @param levels  depth fractions of the levels, 0 to 1; empty: graded by `first_layer` [mm]
[[nodiscard]] std::vector<Vec3> patch_nodes(const PatchTemplate& t, const PatchGeometry& geometry,
                                            double first_layer,
                                            std::span<const double> levels = {});

}  // namespace palpate::stiffness
