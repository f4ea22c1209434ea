// SPDX-License-Identifier: GPL-3.0-or-later
// From the template to the head: a change of shape, the jaw's pose, a place.
#pragma once
#include <Eigen/Dense>

#include "skull/jaw.hpp"
#include "skull/spline_lattice.hpp"

namespace palpate::skull {

/// x -> linear * pose(x + u(x)) + translation with u the lattice's field and the pose acting with
/// the jaw's weight at x; template [mm] to head [mm].
struct SkullMap {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  SplineLattice lattice;
  Eigen::MatrixX3d control;  ///< [mm] one row per control point, template frame
  Jaw jaw{};
  JawPose pose{};

  [[nodiscard]] Vec3 operator()(const Vec3& x) const;
  /// d map / d x.
  [[nodiscard]] Mat3 gradient(const Vec3& x) const;
  /// x + u(x), [mm] template; `weights` are the lattice's at x.
  [[nodiscard]] Vec3 shaped(const Vec3& x, const SplineWeights& weights) const;
};

}  // namespace palpate::skull
