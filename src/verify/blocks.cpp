// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/blocks.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <random>

namespace palpate::verify {

fem::LameModuli flesh_moduli() {
  return fem::lame_moduli(kFleshModulus, kFleshPoisson);
}

fem::TetMesh cube(int n) {
  constexpr int kSix[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                              {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  fem::TetMesh mesh;
  const auto id = [n](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (int k = 0; k <= n; ++k) mesh.nodes.push_back(Vec3(i, j, k) / n);
  for (int cell = 0; cell < n * n * n; ++cell) {
    const int i = cell / (n * n), j = cell / n % n, k = cell % n;
    for (const auto& tet : kSix) {
      for (const int c : tet) mesh.tets.push_back(id(i + (c >> 2), j + (c >> 1 & 1), k + (c & 1)));
      if (fem::corner_volume(mesh, mesh.size() - 1) < 0)
        std::swap(mesh.tets[mesh.tets.size() - 1], mesh.tets[mesh.tets.size() - 2]);
    }
  }
  return mesh;
}

bool on_cube_surface(const Vec3& p) {
  return p.minCoeff() < 1e-9 || p.maxCoeff() > 1 - 1e-9;
}

void shake(fem::TetMesh& mesh, double share, std::uint64_t seed) {
  const double cell = 1 / (std::cbrt(static_cast<double>(mesh.nodes.size())) - 1);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> d(-share * cell, share * cell);
  for (Vec3& p : mesh.nodes) {
    if (on_cube_surface(p)) continue;
    for (double& x : p) x += d(random);
  }
}

fem::TetMesh in_order(const fem::TetMesh& linear, fem::ElementOrder order) {
  return order == fem::ElementOrder::linear ? linear : fem::to_quadratic(linear);
}

Eigen::VectorXd times(const fem::SparsePattern& p, const std::vector<double>& values,
                      const Eigen::VectorXd& x) {
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  for (int c = 0; c < p.size; ++c)
    for (int i = p.column_start[c]; i < p.column_start[c + 1]; ++i) {
      y[p.row[i]] += values[i] * x[c];
      if (p.row[i] != c) y[c] += values[i] * x[p.row[i]];
    }
  return y;
}

CpuSeconds CpuSeconds::now() {
  const auto of = [](int who) {
    rusage u{};
    getrusage(who, &u);
    return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
  };
  return {of(RUSAGE_SELF), of(RUSAGE_CHILDREN)};
}

std::string CpuSeconds::since(const std::string& other) const {
  const CpuSeconds end = now();
  return fmt::format("{} {:.1f} CPU s, ours {:.1f}", other, end.children - children,
                     end.ours - ours);
}

}  // namespace palpate::verify
