// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/repair.hpp"

#include "surface/holes.hpp"
#include "surface/query.hpp"
#include "surface/remesh.hpp"
#include "surface/soup.hpp"

namespace palpate::surface {
WorkingSurface make_working_surface(const SurfaceMesh& scan, const RepairOptions& options,
                                    const Progress& progress) {
  WorkingSurface w;
  CornerMesh m = manifold_from_soup(scan, w.report);
  fill_holes(m, options.target_edge, progress);
  const SurfaceQuery q(m.to_surface());
  thin(m, 0.5 * options.target_edge, progress);
  remesh(m, q, options.target_edge, 5, progress);
  w.mesh = m.to_surface();
  w.filled.resize(w.mesh.points.size());
  return w;
}
}  // namespace palpate::surface
