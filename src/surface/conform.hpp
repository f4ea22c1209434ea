// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the points of a coarse surface so that its faces, not only its points, follow a fine one.
#pragma once
#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"

namespace palpate::surface {

/// A mesh whose points lie on a curved surface cuts its convex parts by h^2/8r. Each point moves
/// along its normal by the mean offset of the samples on its faces, a few times over; points
/// without samples and moves that would fold a face are left out.
/// @param samples  [mm] points of the fine surface; those farther than `edge` are ignored
/// @pre closed
/// @note Deterministic; same bits for any thread count.
void conform(CornerMesh& mesh, const std::vector<Vec3>& samples, double edge,
             const Progress& progress);

}  // namespace palpate::surface
