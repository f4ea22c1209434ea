// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the points of a coarse surface so that its faces, not only its points, follow a fine one.
#pragma once
#include "core/progress.hpp"
#include "surface/corner_mesh.hpp"

namespace palpate::surface {

/// A point of the fine surface.
struct SurfaceSample {
  Vec3 point;   ///< [mm]
  Vec3 normal;  ///< [-] unit, outward
};

/// A mesh whose points lie on a curved surface cuts its convex parts by h^2/8r. Each point moves
/// along its normal by the mean offset of the samples on its faces and its neighbours', a few times
/// over, at most a fifth of an edge in all. Points without samples and moves that would fold a face
/// are left out, and so are those near covers.
/// @param samples  those farther than half an edge, or that face another way, are ignored
/// @pre closed
/// @note Deterministic; same bits for any thread count.
void conform(CornerMesh& mesh, const std::vector<SurfaceSample>& samples, double edge,
             const Progress& progress);

/// One flag per point: 1 on covers and next to them.
[[nodiscard]] std::vector<std::uint8_t> near_covers(const CornerMesh& mesh);

/// Averages the points on and next to covers, so that skin and cover blend.
/// @pre closed
void blend_covers(CornerMesh& mesh);

}  // namespace palpate::surface
