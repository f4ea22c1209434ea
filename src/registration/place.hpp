// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form placement of the template skull in a head: from named pairs of points.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "core/skull.hpp"

namespace palpate::registration {

/// Two points that mean the same place, on the thing that is moved and where it should come to lie.
struct PointPair {
  std::string name;
  Vec3 from = Vec3::Zero();  ///< [mm] on the template
  Vec3 to = Vec3::Zero();    ///< [mm] on the head
  double weight = 1;         ///< [-] >= 0
};

/// x -> linear * x + translation, with what it leaves at each pair.
struct Placement {
  Mat3 linear = Mat3::Identity();
  Vec3 translation = Vec3::Zero();             ///< [mm]
  std::map<std::string, double> residuals_mm;  ///< distance left at each pair, by name
  double rms_mm = 0;                           ///< root of eq. 4.5's least value
  std::vector<std::string> warnings;

  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return linear * p + translation; }
};

/// The rotation R and translation T that minimise (1/N) sum w |to - R from - T|^2 (eq. 4.5). The
/// pairs correspond by meaning, so this closed form is what ICP would converge to.
/// @throws InputError  fewer than three pairs, or pairs on one line (no rotation follows)
/// @note Deterministic; always a proper rotation, never a mirror image.
/// @cite Kabsch 1978; Umeyama 1991, "Least-squares estimation of transformation parameters"
[[nodiscard]] Placement fit_rigid(std::span<const PointPair> pairs);
/// The same with one scale factor (> 0) besides: linear = scale * R.
[[nodiscard]] Placement fit_similarity(std::span<const PointPair> pairs);

/// The registration points that head and template share, in the order of their names.
[[nodiscard]] std::vector<PointPair> shared_pairs(const HeadSurface& head,
                                                  const SkullTemplate& skull);

/// The published placement (source 4.2.2): the template is scaled per axis to the head without ears
/// and neck, then moved rigidly by eq. 4.5 on the five pairs nose_tip, nose_corner_left,
/// nose_corner_right, eye_outer_left, eye_outer_right.
/// Where the scan ends above the chin the vertical scale cannot be read off it and the mean of the
/// other two is used (a warning says so).
/// @throws InputError  one of the five is missing: names it
[[nodiscard]] Placement place_published(const HeadSurface& head, const SkullTemplate& skull);

/// One scale, rotation and translation: size and position from the boxes of head and template
/// (sides, back and crown, where the scan has them), turned and shifted by the shared pairs.
/// @throws InputError  fewer than three shared pairs
[[nodiscard]] Placement place_similarity(const HeadSurface& head, const SkullTemplate& skull);

/// The template with mesh, landmarks and registration points moved; normals stay unit normals.
[[nodiscard]] SkullTemplate placed(SkullTemplate skull, const Placement& placement);

}  // namespace palpate::registration
