// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/ffd.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "core/error.hpp"
#include "shapes.hpp"
#include "skull/published.hpp"

namespace palpate::skull {
namespace {

const Box kBox{{-70, -90, -80}, {70, 120, 100}};

Vec3 in_box(std::mt19937& random, const Box& box) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return box.low + box.size().cwiseProduct(Vec3(x, y, z));
}

void weigh_at_random(BernsteinLattice& lattice, std::mt19937& random) {
  for (double& w : lattice.weight) w = random() % 2 ? 1.0 : 0.5;
}

TEST(Ffd, BernsteinPolynomialsAreAPartitionOfUnityWithTheKnownMean) {
  for (const int n : {1, 8, 12})
    for (double s = 0; s <= 1; s += 0.125) {
      const std::vector<double> b = bernstein(n, s);
      EXPECT_NEAR(std::accumulate(b.begin(), b.end(), 0.0), 1, 1e-14);
      double mean = 0;
      for (int i = 0; i <= n; ++i) {
        EXPECT_GE(b[i], 0);
        mean += b[i] * i / n;
      }
      EXPECT_NEAR(mean, s, 1e-14);  // linear precision
    }
  EXPECT_NEAR(bernstein(8, 0.3)[2], 28 * std::pow(0.7, 6) * 0.09, 1e-15);
}

TEST(Ffd, AllFormsLeaveAnUntouchedObjectWhenWeightsAreEqual) {
  std::mt19937 random(1);
  const BernsteinLattice lattice = make_lattice(kBox, {8, 12, 8});
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 x = in_box(random, kBox);
    for (const FfdForm form : {FfdForm::literal, FfdForm::rational, FfdForm::displacement})
      EXPECT_LT((deform(lattice, x, form) - x).norm(), 1e-11);
  }
}

TEST(Ffd, LiteralFormMovesAnUntouchedObjectAndTheDisplacementFormDoesNot) {
  std::mt19937 random(2);
  BernsteinLattice lattice = make_lattice(kBox, {8, 12, 8});
  weigh_at_random(lattice, random);
  double literal = 0, rational = 0, displacement = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 x = in_box(random, kBox);
    literal = std::max(literal, (deform(lattice, x, FfdForm::literal) - x).norm());
    rational = std::max(rational, (deform(lattice, x, FfdForm::rational) - x).norm());
    displacement = std::max(displacement, (deform(lattice, x, FfdForm::displacement) - x).norm());
  }
  EXPECT_GT(literal, 20);   // [mm]
  EXPECT_LT(rational, 20);  // weights alone still shift points
  EXPECT_GT(rational, 0.1);
  EXPECT_EQ(displacement, 0);
}

TEST(Ffd, RationalFormIsAffineInvariantAndTheLiteralFormIsNot) {
  std::mt19937 random(3);
  BernsteinLattice lattice = make_lattice(kBox, {8, 12, 8});
  weigh_at_random(lattice, random);
  for (Vec3& p : lattice.moved) p += 0.05 * in_box(random, kBox);
  BernsteinLattice shifted = lattice;
  const Mat3 turn = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(10, -20, 30);
  for (Vec3& p : shifted.moved) p = turn * p + shift;
  const Vec3 x = in_box(random, kBox);
  EXPECT_LT((deform(shifted, x, FfdForm::rational) -
             (turn * deform(lattice, x, FfdForm::rational) + shift))
                .norm(),
            1e-10);
  EXPECT_GT(
      (deform(shifted, x, FfdForm::literal) - (turn * deform(lattice, x, FfdForm::literal) + shift))
          .norm(),
      1);
}

TEST(Ffd, EqualControlDisplacementsMoveEverythingAlike) {
  std::mt19937 random(4);
  BernsteinLattice lattice = make_lattice(kBox, {3, 4, 5});
  weigh_at_random(lattice, random);
  for (Vec3& p : lattice.moved) p += Vec3(1, 2, 3);
  const Vec3 x = in_box(random, kBox);
  EXPECT_LT((deform(lattice, x, FfdForm::displacement) - x - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST(Ffd, RefusesAFlatBox) {
  EXPECT_THROW(make_lattice({{0, 0, 0}, {1, 1, 0}}, {2, 2, 2}), InputError);
}

TEST(Published, ControlPointsNearTheHeadAreHeavy) {
  const surface::SurfaceQuery head(ellipsoid({80, 80, 80}, 0, 4));
  BernsteinLattice lattice = make_lattice({{-80, -80, -80}, {80, 80, 80}}, {8, 8, 8});
  PublishedFitOptions options;
  weigh_control_points(lattice, head, options);
  const double radius = 0.5 * std::sqrt(3.0) * 20;  // half the diagonal of a 20 mm cell
  for (std::size_t c = 0; c < lattice.rest.size(); ++c) {
    const double away = std::abs(lattice.rest[c].norm() - 80);
    if (std::abs(away - radius) < 1) continue;  // the sphere is made of flat triangles
    EXPECT_EQ(lattice.weight[c], away < radius ? options.heavy_weight : options.light_weight);
  }
}

TEST(Published, RegionWeightsFallFromTheRegionOutwards) {
  const SurfaceMesh mesh = unit_sphere(4);
  SurfaceMesh large = mesh;
  for (Vec3& p : large.points) p *= 80;
  std::vector<SkullRegion> region;
  for (const Vec3& p : mesh.points)
    region.push_back(p.y() > 0.8 ? SkullRegion::cranium : SkullRegion::jaw);
  const std::vector<double> w = region_weights(large, region, SkullRegion::cranium, {});
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (region[i] == SkullRegion::cranium) {
      EXPECT_EQ(w[i], 1);
    } else {
      EXPECT_LE(w[i], 0.5);
      EXPECT_GE(w[i], 0.1 - 1e-12);
      if (mesh.points[i].y() < -0.5) {
        EXPECT_NEAR(w[i], 0.1, 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::skull
