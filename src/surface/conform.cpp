// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/conform.hpp"

#include <tbb/parallel_for.h>

#include "surface/query.hpp"
#include "surface/remesh.hpp"

namespace palpate::surface {

void conform(CornerMesh& m, const std::vector<Vec3>& samples, double edge,
             const Progress& progress) {
  constexpr int kRounds = 6;  // the offset shrinks by about half each time
  std::vector<ClosestPoint> foot(samples.size());
  for (int round = 0; round < kRounds; ++round) {
    progress.step("fitting the working surface", static_cast<double>(round) / kRounds);
    const SurfaceMesh surface = m.to_surface();
    const SurfaceQuery query(surface);
    const std::vector<Vec3> normal = vertex_normals(surface);
    tbb::parallel_for(std::size_t{0}, samples.size(),
                      [&](std::size_t i) { foot[i] = query.closest(samples[i], edge); });
    std::vector<double> offset(m.points.size(), 0), weight(m.points.size(), 0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (foot[i].triangle < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const auto v = surface.triangles[foot[i].triangle][k];
        const double w = foot[i].barycentric[k];
        offset[v] += w * normal[v].dot(samples[i] - foot[i].point);
        weight[v] += w;
      }
    }
    for (std::size_t v = 0; v < m.points.size(); ++v) {
      if (weight[v] == 0) continue;
      const Vec3 p = m.points[v] + offset[v] / weight[v] * normal[v];
      if (keeps_direction(m, static_cast<CornerMesh::Id>(v), p)) m.points[v] = p;
    }
  }
}

}  // namespace palpate::surface
