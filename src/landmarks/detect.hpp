// SPDX-License-Identifier: GPL-3.0-or-later
// Where the face's named points are, and how the head is turned.
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
};

struct Detection {
  HeadFrame frame;        ///< scan [mm] -> head frame
  LandmarkSet landmarks;  ///< scan frame, [mm]
  std::vector<std::string> warnings;
};

/// @param skin  closed working surface in the scan's frame, [mm] (surface::make_working_surface)
/// @throws InputError  no face found (a cube, a hand), no back of the head: says what was looked
/// for
/// @note Deterministic. Heads within 15 degrees of some signed-axis frame.
[[nodiscard]] Detection detect_landmarks(const SurfaceMesh& skin, const DetectOptions& options = {},
                                         const Progress& progress = {});

}  // namespace palpate::landmarks
