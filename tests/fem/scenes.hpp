// SPDX-License-Identifier: GPL-3.0-or-later
// Small meshes that tests share.
#pragma once
#include <random>

#include "fem/tet_mesh.hpp"

namespace palpate::fem::scenes {

/// Unit cube, n cells a side, six tetrahedra per cell.
inline TetMesh cube(int n) {
  constexpr int kSix[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  TetMesh mesh;
  const auto id = [n](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) mesh.nodes.push_back(Vec3(i, j, k) / n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (const auto& tet : kSix) {
          for (const int c : tet)
            mesh.tets.push_back(id(i + (c >> 2), j + (c >> 1 & 1), k + (c & 1)));
          if (corner_volume(mesh, mesh.size() - 1) < 0)
            std::swap(mesh.tets[mesh.tets.size() - 1], mesh.tets[mesh.tets.size() - 2]);
        }
  return mesh;
}

/// Moves the inner nodes at random by up to `share` of a cell.
inline void shake(TetMesh& mesh, double share, std::uint64_t seed) {
  const double cell = 1 / (std::cbrt(static_cast<double>(mesh.nodes.size())) - 1);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> d(-share * cell, share * cell);
  for (Vec3& p : mesh.nodes)
    if (p.minCoeff() > 1e-9 && p.maxCoeff() < 1 - 1e-9) p += Vec3(d(random), d(random), d(random));
}

inline bool on_cube_surface(const Vec3& p) {
  return p.minCoeff() < 1e-9 || p.maxCoeff() > 1 - 1e-9;
}

/// The mesh in the asked order.
inline TetMesh in_order(const TetMesh& linear, ElementOrder order) {
  return order == ElementOrder::linear ? linear : to_quadratic(linear);
}

}  // namespace palpate::fem::scenes
