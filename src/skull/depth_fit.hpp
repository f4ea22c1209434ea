// SPDX-License-Identifier: GPL-3.0-or-later
// The default fit: similarity, then affine, then a stiff spline volume, each by Gauss-Newton.
#pragma once
#include <Eigen/Dense>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "registration/place.hpp"
#include "skull/depth_terms.hpp"
#include "skull/fit.hpp"
#include "skull/spline_lattice.hpp"

namespace palpate::skull {

/// x -> linear * (x + u(x)) + translation with u the lattice's field; template [mm] to head [mm].
struct SkullMap {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  SplineLattice lattice;
  Eigen::MatrixX3d control;  ///< [mm] one row per control point, template frame

  [[nodiscard]] Vec3 operator()(const Vec3& x) const;
  /// d map / d x.
  [[nodiscard]] Mat3 gradient(const Vec3& x) const;
};

struct DepthFit {
  SkullMap map;
  int iterations = 0;             ///< Gauss-Newton steps of all stages
  double energy = 0;              ///< [-] at the end
  double bending_used = 0;        ///< [mm] after stiffening, if any was needed
  double least_jacobian = 0;      ///< [-] of the spline map (1 at rest) over the template's points
  Eigen::MatrixXd information{};  ///< [1/mm^2] second derivatives of the energy at the end (Gauss-
                                  ///< Newton); rows as in spline_stiffness. Its inverse is the
                                  ///< covariance of the control points
};

/// The part of the energy that holds the spline: bending/2 * (sum u^T K u + asymmetry * the same of
/// the part of u that is not mirror symmetric). Rows and columns: x of all control points, then y,
/// z.
[[nodiscard]] Eigen::MatrixXd spline_stiffness(const SplineLattice& lattice,
                                               const DepthFitOptions& options);

/// @throws InputError  fewer than three registration points
[[nodiscard]] DepthFit solve_depth_fit(const SkullTemplate& skull,
                                       const std::vector<FitPoint>& points, const SkinField& skin,
                                       const registration::Placement& start,
                                       const FitOptions& options, const Progress& progress);

}  // namespace palpate::skull
