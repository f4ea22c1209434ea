// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/isosurface.hpp"

#include <array>

namespace palpate::image {
namespace {

constexpr std::array<std::array<int, 3>, 8> kCorner = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};
constexpr std::array<std::array<int, 2>, 12> kEdge = {{{0, 1},
                                                       {2, 3},
                                                       {4, 5},
                                                       {6, 7},
                                                       {0, 2},
                                                       {1, 3},
                                                       {4, 6},
                                                       {5, 7},
                                                       {0, 4},
                                                       {1, 5},
                                                       {2, 6},
                                                       {3, 7}}};

/// Mean crossing of a cell's edges; false where the cell lies on one side.
bool cell_point(const Volume& v, int i, int j, int k, double level, Vec3& place) {
  std::array<double, 8> above{};
  int inside = 0;
  for (int c = 0; c < 8; ++c) {
    above[c] = v.at(i + kCorner[c][0], j + kCorner[c][1], k + kCorner[c][2]) - level;
    inside += above[c] > 0;
  }
  if (inside == 0 || inside == 8) return false;
  Vec3 sum = Vec3::Zero();
  int crossings = 0;
  for (const auto& [a, b] : kEdge) {
    if ((above[a] > 0) == (above[b] > 0)) continue;
    const double t = above[a] / (above[a] - above[b]);
    for (int x = 0; x < 3; ++x) sum[x] += kCorner[a][x] + t * (kCorner[b][x] - kCorner[a][x]);
    ++crossings;
  }
  place = v.place(Vec3(i, j, k) + sum / crossings);
  return true;
}

}  // namespace

SurfaceMesh isosurface(const Volume& v, double level) {
  SurfaceMesh mesh;
  std::vector<std::int32_t> point(v.value.size(), -1);  // of the cell whose low corner is the voxel
  for (int k = 0; k + 1 < v.size[2]; ++k)
    for (int j = 0; j + 1 < v.size[1]; ++j)
      for (int i = 0; i + 1 < v.size[0]; ++i) {
        Vec3 place;
        if (!cell_point(v, i, j, k, level, place)) continue;
        point[v.index(i, j, k)] = static_cast<std::int32_t>(mesh.points.size());
        mesh.points.push_back(place);
      }
  // A left-handed grid turns every quadrilateral over.
  const bool turned = v.step.determinant() < 0;
  const auto quad = [&](std::array<std::int32_t, 4> c, bool flip) {
    for (const std::int32_t p : c)
      if (p < 0) return;
    if (flip != turned) std::swap(c[1], c[3]);
    mesh.triangles.push_back({c[0], c[1], c[2]});
    mesh.triangles.push_back({c[0], c[2], c[3]});
  };
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const std::array<int, 3> at = {i, j, k};
        const bool here = v.at(i, j, k) > level;
        for (int a = 0; a < 3; ++a) {
          std::array<int, 3> next = at;
          const int b = (a + 1) % 3, c = (a + 2) % 3;
          if (++next[a] >= v.size[a] || at[b] == 0 || at[c] == 0) continue;
          if ((v.at(next[0], next[1], next[2]) > level) == here) continue;
          // The four cells around this edge, counter-clockwise seen from its far end.
          std::array<std::int32_t, 4> cells{};
          const std::array<std::array<int, 2>, 4> around = {{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};
          for (int q = 0; q < 4; ++q) {
            std::array<int, 3> cell = at;
            cell[b] += around[q][0];
            cell[c] += around[q][1];
            cells[q] = point[v.index(cell[0], cell[1], cell[2])];
          }
          quad(cells, !here);
        }
      }
  return mesh;
}

}  // namespace palpate::image
