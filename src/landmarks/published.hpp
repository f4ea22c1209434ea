// SPDX-License-Identifier: GPL-3.0-or-later
// The source's landmark recipe (4.2.1; Segundo et al. 2010 carried to point clouds), on a head that
// has been turned to the front.
#pragma once
#include "core/landmarks.hpp"
#include "landmarks/skin.hpp"

namespace palpate::landmarks {

/// Besl & Jain's eight types; the rows of the source's Table 4.1 are K < 0, K = 0, K > 0.
enum class SurfaceType {
  saddle_ridge,
  minimal,
  saddle_valley,
  ridge,
  flat,
  valley,
  peak,
  pit,
  none  ///< K > 0 with H = 0, which no smooth surface has
};

inline constexpr double kZeroMean = 1e-3;      ///< [1/mm] |H| below this counts as 0: radius 1 m
inline constexpr double kZeroGaussian = 1e-5;  ///< [1/mm^2] |K| below this counts as 0

/// From the signs of mean and Gaussian curvature (surface::Curvature's convention: a peak has H <
/// 0).
[[nodiscard]] SurfaceType surface_type(const surface::Curvature& curvature);

/// Nose tip, two nose corners and two outer eye corners, nothing else; confidence 0.5 throughout,
/// since the recipe has no measure of its own.
/// @param frame  scan -> head frame, from the robust method
/// @return scan frame, [mm]
/// @throws InputError  where a profile has no gradient peak or a row no pits
[[nodiscard]] LandmarkSet published_landmarks(const Skin& skin, const HeadFrame& frame);

}  // namespace palpate::landmarks
