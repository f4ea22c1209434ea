// SPDX-License-Identifier: GPL-3.0-or-later
// Rueckert et al., "Nonrigid registration using free-form deformations", IEEE TMI 18 (1999): cubic
// B-splines with bending energy. The integrals factor into products of one-dimensional Gram
// matrices of the basis functions and their derivatives; four Gauss points integrate each exactly
// (degree six).
#include "skull/spline_lattice.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace palpate::skull {
namespace {

/// The four cubic B-splines over one cell, t in [0, 1]: derivative 0, 1 or 2 with respect to t.
std::array<double, 4> cubic(double t, int derivative) {
  const double r = 1 - t;
  if (derivative == 0)
    return {r * r * r / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
            (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
  if (derivative == 1)
    return {-r * r / 2, (3 * t * t - 4 * t) / 2, (-3 * t * t + 2 * t + 1) / 2, t * t / 2};
  return {r, 3 * t - 2, 1 - 3 * t, t};
}

/// Gram matrix of the derivative's basis functions over `cells` cells of width h.
Eigen::MatrixXd gram(int cells, double h, int derivative) {
  constexpr std::array<double, 4> at = {0.069431844202973712, 0.33000947820757187,
                                        0.66999052179242813, 0.93056815579702629};
  constexpr std::array<double, 4> weight = {0.17392742256872693, 0.32607257743127307,
                                            0.32607257743127307, 0.17392742256872693};
  Eigen::Matrix4d cell = Eigen::Matrix4d::Zero();
  for (int q = 0; q < 4; ++q) {
    const std::array<double, 4> b = cubic(at[q], derivative);
    const Eigen::Map<const Eigen::Vector4d> v(b.data());
    cell += weight[q] * v * v.transpose();
  }
  cell *= h * std::pow(h, -2 * derivative);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(cells + 3, cells + 3);
  for (int c = 0; c < cells; ++c) whole.block<4, 4>(c, c) += cell;
  return whole;
}

}  // namespace

SplineLattice::SplineLattice(const Box& box, double spacing) : spacing_(spacing) {
  if (!(box.size().minCoeff() > 0) || !(spacing > 0))
    throw InputError("the spline lattice needs a box with volume and a spacing above zero");
  const double half = std::max(std::abs(box.low.x()), std::abs(box.high.x()));
  const Vec3 low(-half, box.low.y(), box.low.z()), high(half, box.high.y(), box.high.z());
  for (int a = 0; a < 3; ++a) {
    cells_[a] = std::max(1, static_cast<int>(std::ceil((high[a] - low[a]) / spacing - 1e-9)));
    count_[a] = cells_[a] + 3;
    origin_[a] = 0.5 * (low[a] + high[a]) - 0.5 * cells_[a] * spacing;
  }
}

SplineLattice::Place SplineLattice::locate(const Vec3& x) const {
  Place place{};
  for (int a = 0; a < 3; ++a) {
    const double s = (x[a] - origin_[a]) / spacing_;
    place.cell[a] = std::clamp(static_cast<int>(std::floor(s)), 0, cells_[a] - 1);
    place.part[a] = s - place.cell[a];
  }
  return place;
}

SplineWeights SplineLattice::weights(const Vec3& x) const {
  const Place at = locate(x);
  const auto bx = cubic(at.part.x(), 0), by = cubic(at.part.y(), 0), bz = cubic(at.part.z(), 0);
  SplineWeights w;
  int c = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k, ++c) {
        w.control[c] = index(at.cell[0] + i, at.cell[1] + j, at.cell[2] + k);
        w.share[c] = bx[i] * by[j] * bz[k];
      }
  return w;
}

Eigen::Matrix<double, 64, 3> SplineLattice::gradients(const Vec3& x) const {
  const Place at = locate(x);
  std::array<std::array<double, 4>, 3> b, d;
  for (int a = 0; a < 3; ++a) {
    b[a] = cubic(at.part[a], 0);
    d[a] = cubic(at.part[a], 1);
  }
  Eigen::Matrix<double, 64, 3> g;
  int c = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k, ++c)
        g.row(c) << d[0][i] * b[1][j] * b[2][k], b[0][i] * d[1][j] * b[2][k],
            b[0][i] * b[1][j] * d[2][k];
  return g / spacing_;
}

std::vector<std::int32_t> SplineLattice::mirror() const {
  std::vector<std::int32_t> other(size());
  for (int i = 0; i < count_[0]; ++i)
    for (int j = 0; j < count_[1]; ++j)
      for (int k = 0; k < count_[2]; ++k) other[index(i, j, k)] = index(count_[0] - 1 - i, j, k);
  return other;
}

Eigen::MatrixXd SplineLattice::bending() const {
  std::array<std::array<Eigen::MatrixXd, 3>, 3> g;  // [axis][derivative]
  for (int a = 0; a < 3; ++a)
    for (int d = 0; d < 3; ++d) g[a][d] = gram(cells_[a], spacing_, d);
  Eigen::MatrixXd k(size(), size());
  for (int row = 0; row < size(); ++row)
    for (int col = 0; col < size(); ++col) {
      const int i = row / (count_[1] * count_[2]), j = row / count_[2] % count_[1],
                l = row % count_[2];
      const int p = col / (count_[1] * count_[2]), q = col / count_[2] % count_[1],
                r = col % count_[2];
      const auto term = [&](int dx, int dy, int dz) {
        return g[0][dx](i, p) * g[1][dy](j, q) * g[2][dz](l, r);
      };
      k(row, col) = term(2, 0, 0) + term(0, 2, 0) + term(0, 0, 2) +
                    2 * (term(1, 1, 0) + term(0, 1, 1) + term(1, 0, 1));
    }
  return k;
}

}  // namespace palpate::skull
