// SPDX-License-Identifier: GPL-3.0-or-later
// Dihedral angles from the outward face normals n_i: the angle at the edge shared by faces i and j
// is pi - angle(n_i, n_j). Limit cases: a regular tetrahedron has acos(1/3) = 70.53 degrees six
// times; a sliver has angles near 0 and near 180.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tetmesh/tissue.hpp"

namespace palpate::tetmesh {
namespace {

constexpr int kBins = 18;  ///< of 10 degrees

std::array<double, 6> dihedral_degrees(const std::array<Vec3, 4>& p) {
  // Face i is opposite to corner i; the normal's sign is fixed by that corner.
  std::array<Vec3, 4> normal;
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = p[(i + 1) % 4], &b = p[(i + 2) % 4], &c = p[(i + 3) % 4];
    Vec3 n = (b - a).cross(c - a);
    if (n.dot(p[i] - a) > 0) n = -n;
    normal[i] = n.normalized();
  }
  std::array<double, 6> out;
  int k = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      out[k++] =
          180 - std::acos(std::clamp(normal[i].dot(normal[j]), -1.0, 1.0)) * 180 / std::numbers::pi;
  return out;
}

}  // namespace

void measure_quality(TissueMesh& mesh) {
  std::array<double, kBins> histogram{};
  double smallest = 180, largest = 0, sum_of_min = 0, volume_min = INFINITY;
  std::map<TissueLabel, double> volume, count;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = mesh.nodes[mesh.tets[t][i]];
    Mat3 edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = p[i + 1] - p[0];
    const double v = edges.determinant() / 6;
    volume[mesh.label[t]] += v;
    count[mesh.label[t]] += 1;
    volume_min = std::min(volume_min, v);
    const auto angles = dihedral_degrees(p);
    const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
    smallest = std::min(smallest, *low);
    largest = std::max(largest, *high);
    sum_of_min += *low;
    for (const double a : angles) ++histogram[std::min(kBins - 1, static_cast<int>(a / 10))];
  }
  const double tets = std::max<double>(1, static_cast<double>(mesh.tets.size()));
  auto& q = mesh.quality;
  q["nodes"] = static_cast<double>(mesh.nodes.size());
  q["held_nodes"] = static_cast<double>(std::count(mesh.held.begin(), mesh.held.end(), 1));
  q["tets_flesh"] = count[TissueLabel::flesh];
  q["tets_bone"] = count[TissueLabel::bone];
  q["dihedral_min_deg"] = smallest;
  q["dihedral_max_deg"] = largest;
  q["dihedral_mean_min_deg"] = sum_of_min / tets;
  q["tet_volume_min_mm3"] = volume_min;
  q["volume_flesh_mm3"] = volume[TissueLabel::flesh];
  q["volume_bone_mm3"] = volume[TissueLabel::bone];
  for (int b = 0; b < kBins; ++b)
    q[fmt::format("dihedral_share_{:03}_{:03}", b * 10, b * 10 + 10)] = histogram[b] / (6 * tets);
}

}  // namespace palpate::tetmesh
