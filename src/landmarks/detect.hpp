// SPDX-License-Identifier: GPL-3.0-or-later
// Where the face's named points are, and how the head is turned (docs/method/landmarks.md).
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/landmarks.hpp"
#include "core/progress.hpp"
#include "core/surface_mesh.hpp"

namespace palpate::landmarks {

enum class Method { robust, published };

struct DetectOptions {
  Method method = Method::robust;
  std::map<std::string, Vec3> given;  ///< [mm] scan frame; the user's own points override
  /// The scan itself [mm], in the frame of `skin`: where its eyes are open, their corners are taken
  /// from it, sharper than the closed surface has them. May be null.
  const SurfaceMesh* scan = nullptr;
};

struct Detection {
  HeadFrame frame;        ///< scan [mm] -> head frame
  LandmarkSet landmarks;  ///< scan frame, [mm]
  double mouth_opening =
      0;  ///< [rad] of the jaw, good to some 5 degrees; 0 where the mouth is shut
  std::vector<std::string> warnings;
};

/// Robust: a statistical face is laid on the surface from every dome, direction and roll; the best
/// one that passes as a face and has the back of a head behind it gives the frame and, sharpened by
/// the local surface, the points. Published: the source's recipe (4.2.1) in that frame; it knows
/// the nose tip, two nose corners and two outer eye corners only.
/// Confidence: 1 for a given point; 1 less the mean misfit of the neighbouring model points over
/// 6 mm for a robust one; 0.5 for every published one. Optional points (core/landmarks.hpp, and
/// gnathion, subnasale, stomion) below 0.3 are left out: the scan has no such part.
/// @param skin  closed working surface in the scan's frame, any pose, [mm]
///              (surface::make_working_surface)
/// @throws InputError  no face found (a cube, a hand), no back of the head: says what was looked
/// for
/// @note Deterministic; same bits for any thread count.
[[nodiscard]] Detection detect_landmarks(const SurfaceMesh& skin, const DetectOptions& options = {},
                                         const Progress& progress = {});

}  // namespace palpate::landmarks
