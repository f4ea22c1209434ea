// SPDX-License-Identifier: GPL-3.0-or-later
// How far the fitted skull may be off: skulls drawn from the fit's posterior.
#pragma once
#include "skull/depth_fit.hpp"
#include "skull/depth_model.hpp"

namespace palpate::skull {

struct SpreadOptions {
  int draws = 32;           ///< skulls drawn; a standard deviation from 32 is good to 12 %
  double range = 30;        ///< [mm] over which an individual's difference resembles itself: the
                            ///< range of the depth model
  double completed_sd = 6;  ///< [mm] DepthFitOptions::completed_sd: more where skin was completed
  double least_depth = 1;   ///< [mm] no drawn bone is nearer to the skin: skin alone is thicker
  std::uint64_t seed = 1;   ///< of the draws
};

struct SkullSpread {
  std::vector<double> deviation;          ///< [mm] per template point, along the way to the skin
  std::vector<std::vector<Vec3>> offset;  ///< [mm] per draw and template point, head frame
};

/// The table's SD is the whole spread of depth between individuals (with the doubt of interpolating
/// it), and two things make it up. The map's own doubt: Gauss-Newton's linearisation of the
/// posterior, whose prior is the table's depths with their SDs, the spline's bending and its
/// symmetry. And what a smooth map cannot show: how an individual's bone differs from it, a
/// Gaussian field that brings the variance along the way to the skin up to the table's. Where the
/// map itself is less sure than the table (no data near), its doubt stands alone. Under skin that
/// was completed from another head, that skin's own doubt is part of the whole spread.
/// @param fitted  the template's points under `solved.map`, head frame [mm]
/// @note Deterministic. One Cholesky factorisation and `draws` back substitutions.
[[nodiscard]] SkullSpread draw_spread(const SkullTemplate& skull, const std::vector<Vec3>& fitted,
                                      const DepthFit& solved, const DepthModel& model,
                                      const SkinField& skin, const SpreadOptions& options = {});

}  // namespace palpate::skull
