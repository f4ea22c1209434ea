// SPDX-License-Identifier: GPL-3.0-or-later
// The jaw as its own part: a few numbers say how it stands, whatever its shape.
#pragma once
#include "core/skull.hpp"

namespace palpate::skull {

/// How the jaw stands against the bite of the template; all zero: closed.
struct JawPose {
  double opening = 0;  ///< [rad] >= 0, about the line through the condyles
  double advance = 0;  ///< [mm] of the condyles along their path, beyond what the opening brings
  double shift = 0;    ///< [mm] towards the subject's left

  [[nodiscard]] Vec3 vector() const { return {opening, advance, shift}; }
  [[nodiscard]] static JawPose from(const Vec3& v) { return {v[0], v[1], v[2]}; }
};

/// What a jaw may do, before the skin is looked at: independent Gaussians about the closed bite,
/// opening one-sided.
struct JawPrior {
  double opening_sd = 0;  ///< [rad] > 0
  double advance_sd = 0;  ///< [mm] > 0
  double shift_sd = 0;    ///< [mm] > 0

  [[nodiscard]] Vec3 precision() const;  ///< 1/sd^2, in the order of JawPose::vector
};

/// Lips closed: from the bite to the rest position, in which the teeth stand 2 to 4 mm apart, and
/// as much to and fro.
inline constexpr JawPrior kClosedJaw{0.0175, 1.0, 0.5};
/// Lips apart: any opening that a jaw can do. The condyles' path strays between people by 2.8 mm
/// (Fukui et al. 2002, Eur J Orthod 24:327); a jaw can be thrust 8.0 mm forwards and 9.3 mm
/// sideways (Woelfel et al. 2014, J Adv Prosthodont 6:483), which nobody does by chance.
inline constexpr JawPrior kOpenJaw{0.26, 3.0, 2.0};
/// [rad] as far as jaws open: 32 to 34 degrees (Ferrario et al. 2005, Arch Oral Biol 50:635).
inline constexpr double kWidestOpening = 0.58;

/// Where a template's jaw parts from its skull. The template is one shell, closed in the bite and
/// fused at the joint; a weight says how much of the jaw's motion a place takes. It falls from 1 to
/// 0 upwards across a band: narrow through the bite, wide over the ramus, whose upper half and
/// joint stretch. Sideways it is constant.
struct Jaw {
  bool present = false;       ///< false: every weight is zero, and no pose moves anything
  Vec3 hinge = Vec3::Zero();  ///< [mm] on the midplane, between the condyles
  double bite_height = 0;     ///< [mm] of the band's middle at the second molars
  double bite_slope = 0;      ///< [-] its rise per mm forwards
  double bite_half = 1;       ///< [mm] half the band's width there
  double ramus_height = 0;    ///< [mm] of its middle over the ramus
  double ramus_half = 1;      ///< [mm]
  double molar = 1;           ///< [mm] z at which the bite's band begins to rise backwards
  double ramus = 0;           ///< [mm] z at which it has risen; < molar

  /// [-] in 0 ... 1, continuously differentiable. @param x  [mm] template at rest
  [[nodiscard]] double weight(const Vec3& x) const;
  [[nodiscard]] Vec3 weight_gradient(const Vec3& x) const;  ///< [1/mm]
};

/// A skull whose teeth are parted, and where its jaw parts from it.
struct PartedTeeth {
  SkullTemplate skull;
  Jaw jaw;  ///< the same motion above and below the slot; the band through the bite is as narrow
};
/// Cuts a slot of 2 mm through the bite, from the front to behind the second molars, so that no
/// curtain of bone stands between the teeth of an open mouth. The ramus stays whole.
/// @throws SolveError  the template's surface is open, or intersects itself
[[nodiscard]] PartedTeeth part_teeth(const SkullTemplate& skull, const Jaw& jaw);

/// From the template's landmarks (po, go, pr, id, sM2, iM2) and regions jaw and chin. Not present
/// where one is missing: such a skull has no pose.
[[nodiscard]] Jaw find_jaw(const SkullTemplate& skull);

/// A place under the pose, and how it changes. The motion of weight w is the turn by w * opening
/// and w times the glide, so that half a motion is an arc too and shrinks nothing.
struct JawMotion {
  Vec3 position;   ///< [mm]
  Mat3 turn;       ///< [-] d position / d place, the weight held
  Mat3 by_pose;    ///< columns: d position / d opening [mm], advance [-], shift [-]
  Vec3 by_weight;  ///< [mm] d position / d weight
};
/// @param place   [mm] template, after its change of shape
/// @param weight  Jaw::weight of the place at rest
[[nodiscard]] JawMotion move_jaw(const Jaw& jaw, const JawPose& pose, const Vec3& place,
                                 double weight);

}  // namespace palpate::skull
