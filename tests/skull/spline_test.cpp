// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/spline_lattice.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numeric>
#include <random>

#include "skull/depth_fit.hpp"

namespace palpate::skull {
namespace {

const Box kBox{{-70, -90, -80}, {70, 120, 100}};

Vec3 in_box(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0.02, 0.98);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return kBox.low + kBox.size().cwiseProduct(Vec3(x, y, z));
}

double value(const SplineLattice& lattice, const Eigen::VectorXd& u, const Vec3& x) {
  const SplineWeights w = lattice.weights(x);
  double sum = 0;
  for (int c = 0; c < 64; ++c) sum += w.share[c] * u[w.control[c]];
  return sum;
}

/// Control values that reproduce f exactly where f is affine: least squares over many places.
Eigen::VectorXd interpolate(const SplineLattice& lattice, const std::function<double(Vec3)>& f) {
  std::mt19937 random(9);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(8 * lattice.size(), lattice.size());
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index r = 0; r < a.rows(); ++r) {
    const Vec3 x = in_box(random);
    const SplineWeights w = lattice.weights(x);
    for (int c = 0; c < 64; ++c) a(r, w.control[c]) = w.share[c];
    b[r] = f(x);
  }
  Eigen::MatrixXd normal = a.transpose() * a;
  normal += 1e-9 * lattice.bending() * normal.trace() / lattice.bending().trace();
  return normal.ldlt().solve(a.transpose() * b);
}

TEST(SplineLattice, SharesSumToOneAndGradientsAreTheirDifferences) {
  const SplineLattice lattice(kBox, 40);
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 x = in_box(random);
    const SplineWeights w = lattice.weights(x);
    EXPECT_NEAR(std::accumulate(w.share.begin(), w.share.end(), 0.0), 1, 1e-13);
    const auto g = lattice.gradients(x);
    constexpr double kStep = 1e-5;
    for (int a = 0; a < 3; ++a) {
      const SplineWeights up = lattice.weights(x + kStep * Vec3::Unit(a));
      const SplineWeights down = lattice.weights(x - kStep * Vec3::Unit(a));
      if (up.control != down.control) continue;
      for (int c = 0; c < 64; ++c)
        EXPECT_NEAR(g(c, a), (up.share[c] - down.share[c]) / (2 * kStep), 1e-9);
    }
  }
}

TEST(SplineLattice, BendingVanishesForAffineFieldsAndIsTheIntegralForAQuadratic) {
  const SplineLattice lattice({{-60, -60, -60}, {60, 60, 60}}, 60);
  const Eigen::MatrixXd k = lattice.bending();
  EXPECT_LT((k - k.transpose()).norm(), 1e-9 * k.norm());
  const Eigen::VectorXd affine = interpolate(
      lattice, [](const Vec3& x) { return 3 + 0.1 * x.x() - 0.2 * x.y() + 0.05 * x.z(); });
  EXPECT_NEAR(value(lattice, affine, {10, 20, -30}), 3 + 1 - 4 - 1.5, 1e-5);
  EXPECT_NEAR(affine.dot(k * affine), 0, 1e-6);
  // u = a x^2 + b x y: u_xx = 2a, u_xy = b, integral over 120^3 mm^3 of 4 a^2 + 2 b^2.
  const double a = 1e-3, b = 2e-3;
  const Eigen::VectorXd bent =
      interpolate(lattice, [&](const Vec3& x) { return a * x.x() * x.x() + b * x.x() * x.y(); });
  EXPECT_NEAR(bent.dot(k * bent) / ((4 * a * a + 2 * b * b) * 120. * 120. * 120.), 1, 1e-3);
}

TEST(SplineLattice, MirrorImageOfAFieldHasTheSameBending) {
  const SplineLattice lattice(kBox, 40);
  const std::vector<std::int32_t> mirror = lattice.mirror();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd u(lattice.size()), flipped(lattice.size());
  for (int i = 0; i < lattice.size(); ++i) u[i] = uniform(random);
  for (int i = 0; i < lattice.size(); ++i) flipped[i] = u[mirror[i]];
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 x = in_box(random);
    EXPECT_NEAR(value(lattice, flipped, x), value(lattice, u, Vec3(-x.x(), x.y(), x.z())), 1e-12);
  }
  const Eigen::MatrixXd k = lattice.bending();
  EXPECT_NEAR(u.dot(k * u), flipped.dot(k * flipped), 1e-9 * u.dot(k * u));
}

TEST(SplineLattice, AsymmetryCostsExtraAndSymmetryDoesNot) {
  const SplineLattice lattice(kBox, 60);
  const int n = lattice.size();
  const std::vector<std::int32_t> mirror = lattice.mirror();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::VectorXd u(3 * n), flipped(3 * n);
  for (Eigen::Index i = 0; i < 3 * n; ++i) u[i] = uniform(random);
  for (int i = 0; i < n; ++i)
    for (int a = 0; a < 3; ++a) flipped[a * n + i] = (a == 0 ? -1 : 1) * u[a * n + mirror[i]];
  DepthFitOptions even, plain;
  even.asymmetry = 2;
  plain.asymmetry = 0;
  const Eigen::MatrixXd with = spline_stiffness(lattice, even);
  const Eigen::MatrixXd without = spline_stiffness(lattice, plain);
  const Eigen::VectorXd symmetric = 0.5 * (u + flipped), skew = 0.5 * (u - flipped);
  const auto energy = [](const Eigen::MatrixXd& k, const Eigen::VectorXd& v) {
    return v.dot(k * v);
  };
  EXPECT_NEAR(energy(with, symmetric) / energy(without, symmetric), 1, 1e-9);
  EXPECT_NEAR(energy(with, skew) / energy(without, skew), 3, 1e-9);
}

}  // namespace
}  // namespace palpate::skull
