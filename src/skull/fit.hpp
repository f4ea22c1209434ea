// SPDX-License-Identifier: GPL-3.0-or-later
// The template skull brought under one head's skin.
#pragma once
#include <array>
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "skull/ffd.hpp"

namespace palpate::skull {

enum class Method { depth, published };

/// Choices that the source leaves open (docs/method/fit.md); recorded in the output.
struct PublishedFitOptions {
  std::array<int, 3> cells{8, 12, 8};  ///< l, m, n of the lattice
  double heavy_weight = 1.0;           ///< [-] control point near the head (Algorithm 1); > 0
  double light_weight = 0.5;           ///< [-] the others; > 0
  FfdForm form = FfdForm::rational;    ///< how eq. 4.9 is read
  double outside_near = 0.5;           ///< [-] share of the motion right beside the region
  double outside_far = 0.1;            ///< [-] and from `outside_reach` on
  double outside_reach = 60;           ///< [mm] > 0; about one region's width
};

/// Weights of the depth fit. One "independent observation" is one landmark of the table.
struct DepthFitOptions {
  double spacing = 40;      ///< [mm] between control points of the spline volume; 20 to 80
  double bending = 0.3;     ///< [1/mm] resistance of the spline; > 0. Small values inflate the jaw
  double asymmetry = 1;     ///< [-] extra share of `bending` against asymmetric change; >= 0
  double strain_sd = 0.05;  ///< [-] spread of head proportions around one scale (affine stage)
  double shear_sd = 0.02;   ///< [-] spread of shear
  double sampling = 5;      ///< [mm] grid of the bone points that are looked at
  /// [mm^2] of bone that counts as one independent observation: pi range^2, the integral of the
  /// squared correlation exp(-r^2 / range^2) of the individual's depth field (range 30 mm, the
  /// same as in its spread). Less trusts the interpolation between landmarks too much
  double patch_area = 2830;
  double limit_area = 400;     ///< [mm^2] of bone whose clearance counts once; the less the firmer
  double landmark_weight = 1;  ///< [-] observations per landmark of the table
  double registration_sd = 4;  ///< [mm] spread of eye corners, alae and nose tip against bone
  double ear_sd = 6;   ///< [mm] spread of the auricle's centre against the porion, up and back
  double chin_sd = 6;  ///< [mm] spread of the height of the skin's chin against the bone's
  /// [mm] spread of skin that was completed from another head against the person's own
  /// (HeadSurface::filled == 2), on top of the table's spread of depth below it
  double completed_sd = 6;
  bool jaw_pose = true;          ///< the jaw may stand open; false: an open mouth is a shape
  double facing = 0.3;           ///< [-] least cosine between bone normal and direction to the skin
  double huber = 2;              ///< [sd] beyond which a misfit pulls no harder
  double limit_margin = 0.3;     ///< [mm] on top of the clearance while fitting
  double limit_sd = 0.5;         ///< [mm] give of the clearance while fitting
  double least_jacobian = 0.3;   ///< [-] below it the spline is made stiffer and solved again
  int max_iterations = 30;       ///< Gauss-Newton steps per stage
  double step_tolerance = 0.05;  ///< [mm] largest motion of a point at which a stage is done
};

struct FitOptions {
  Method method = Method::depth;
  double clearance = 2.5;  ///< [mm] least skin-bone distance where the table is thicker; > 0
  DepthFitOptions depth;
  PublishedFitOptions published;
};

/// @param head    working skin with landmarks, head frame [mm]
/// @param depths  published soft-tissue depths
/// @throws InputError  a landmark that the fit needs is missing
/// @throws SolveError  the skull could not be kept inside the skin
/// @note Same bits for any thread count.
[[nodiscard]] SkullFit fit_skull(const HeadSurface& head, const SkullTemplate& skull,
                                 const std::vector<TissueDepth>& depths,
                                 const FitOptions& options = {}, const Progress& progress = {});

}  // namespace palpate::skull
