// SPDX-License-Identifier: GPL-3.0-or-later
// The default fit: similarity, then affine, then a stiff spline volume, each by Gauss-Newton
// together with the jaw's pose.
#pragma once
#include <Eigen/Dense>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "registration/place.hpp"
#include "skull/depth_terms.hpp"
#include "skull/fit.hpp"
#include "skull/skull_map.hpp"

namespace palpate::skull {

struct DepthFit {
  SkullMap map;
  bool mouth_open = false;        ///< the jaw's pose is that of an open mouth
  int iterations = 0;             ///< Gauss-Newton steps of all stages
  double energy = 0;              ///< [-] at the end
  double bending_used = 0;        ///< [mm] after stiffening, if any was needed
  double least_jacobian = 0;      ///< [-] of the spline map (1 at rest) over the template's points
  Eigen::MatrixXd information{};  ///< [1/mm^2] second derivatives of the energy at the end (Gauss-
                                  ///< Newton); rows as in spline_stiffness, then the jaw's pose
                                  ///< (1/rad^2, 1/mm^2, 1/mm^2). Its inverse is their covariance
};

/// The part of the energy that holds the spline: bending/2 * (sum u^T K u + asymmetry * the same of
/// the part of u that is not mirror symmetric). Rows and columns: x of all control points, then y,
/// z.
[[nodiscard]] Eigen::MatrixXd spline_stiffness(const SplineLattice& lattice,
                                               const DepthFitOptions& options);

/// @param mouth_opening  [rad] where the skin shows an open mouth: the jaw is then looked for open,
///                       from there. 0: both ways are tried where the bone suggests it
/// @throws InputError  fewer than three registration points
[[nodiscard]] DepthFit solve_depth_fit(const SkullTemplate& skull,
                                       const std::vector<FitPoint>& points, const SkinField& skin,
                                       const registration::Placement& start, double mouth_opening,
                                       const FitOptions& options, const Progress& progress);

}  // namespace palpate::skull
