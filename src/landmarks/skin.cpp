// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/skin.hpp"

namespace palpate::landmarks {

Skin::Skin(const SurfaceMesh& m)
    : mesh(m),
      normals(vertex_normals(m)),
      tree(m.points),
      query(m),
      curvature(surface::curvature_by_radius(m, kDomeRadius)) {}

}  // namespace palpate::landmarks
