// SPDX-License-Identifier: GPL-3.0-or-later
// A shrink-wrapped surface around anything: the last resort of repair.
#pragma once
#include "core/surface_mesh.hpp"

namespace palpate::surface {

/// Closed 2-manifold without self-intersections that encloses the triangles at `offset` [mm]; holes
/// and gaps narrower than `alpha` [mm] are bridged.
/// @pre finite coordinates; a surface without holes wider than alpha, or the wrap goes inside
/// @cite Portaneri et al. 2022, "Alpha wrapping with an offset"
[[nodiscard]] SurfaceMesh alpha_wrap(const SurfaceMesh& mesh, double alpha, double offset);

}  // namespace palpate::surface
