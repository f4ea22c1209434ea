// SPDX-License-Identifier: GPL-3.0-or-later
// The depth fit's first two stages, and what all three share.
#pragma once
#include <vector>

#include "registration/place.hpp"
#include "skull/depth_terms.hpp"
#include "skull/jaw.hpp"

namespace palpate::skull {

/// How high the lower face's bone is for the skull's size in closed bite: from the maxilla below
/// the nasal spine (ss) to menton. Without it a stretched face explains an open mouth as well as
/// the mouth.
struct FaceHeight {
  Vec3 upper = Vec3::Zero(), lower = Vec3::Zero();  ///< [mm] template
  Vec3 span = Vec3::Zero();                         ///< [mm] upper - lower
  double precision = 0;  ///< [1/mm^2]; 0 where the template lacks a point or a jaw

  /// [mm] of a skull `scale` times the template's size.
  [[nodiscard]] double wanted(double scale) const { return scale * span.norm(); }
  /// [-] template: way . (upper - lower), both after the change of shape, is the height in the
  /// head.
  [[nodiscard]] Vec3 way(const Mat3& linear) const {
    return linear.transpose() * (linear * span).stableNormalized();
  }
};
[[nodiscard]] FaceHeight find_face_height(const SkullTemplate& skull, const Jaw& jaw);

/// One fit: what is placed, what it should satisfy, and what the jaw may do.
struct FitProblem {
  const std::vector<FitPoint>& points;
  const SkinField& skin;
  const FitOptions& options;
  const Jaw& jaw;
  JawPrior prior;
  std::vector<double> weight;  ///< [-] Jaw::weight of each point
  FaceHeight height;
};

/// x -> linear * pose(x) + translation.
struct CoarseFit {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  JawPose pose;
  double scale = 1;    ///< [-] of the similarity
  int iterations = 0;  ///< Gauss-Newton steps of both stages
};

/// Similarity, then affine, each by Gauss-Newton together with the jaw's pose.
/// @param opening  [rad] of the jaw to begin with
[[nodiscard]] CoarseFit solve_coarse(const FitProblem& problem,
                                     const registration::Placement& start, double opening = 0);

/// Largest distance between points of the same number, [mm].
[[nodiscard]] double largest_motion(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

/// The pose after a step, within what jaws do: no bite is closed further than shut.
[[nodiscard]] JawPose stepped(const JawPose& pose, const Vec3& step);

/// Whether the opening stands at an end of its range and `pull` (minus the energy's slope) would
/// take it beyond: then it is no unknown of this step.
[[nodiscard]] bool opening_is_held(const JawPose& pose, double pull);

}  // namespace palpate::skull
