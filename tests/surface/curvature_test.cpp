// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/curvature.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.hpp"
#include "shapes.hpp"

namespace palpate::surface {
namespace {

// The vertex nearest to the origin of a graph over a square.
std::size_t middle(int n) {
  return static_cast<std::size_t>((n / 2) * (n + 1) + n / 2);
}

TEST(Curvature, SphereOutwardIsNegativeMean) {
  const double r = 40;
  const SurfaceMesh m = shapes::sphere(r, 5, Vec3(7, -3, 900));
  for (const auto& all : {curvature_by_neighbours(m), curvature_by_radius(m, 6)})
    for (const Curvature& c : all) {
      ASSERT_NEAR(c.mean * r, -1, 0.02);
      ASSERT_NEAR(c.gaussian * r * r, 1, 0.04);
    }
}

TEST(Curvature, CylinderBendsAroundItsAxisOnly) {
  const double r = 30, length = 200;
  const SurfaceMesh m = shapes::grid(120, 120, false, [&](double u, double v) {
    return Vec3(r * std::cos(v), r * std::sin(v), -length * (u - 0.5));
  });
  ASSERT_GT((vertex_normals(m)[60 * 120]).x(), 0.99);  // outward
  const auto all = curvature_by_neighbours(m);
  for (int i = 20; i < 100; ++i) {
    const Curvature& c = all[static_cast<std::size_t>(i * 120 + i)];
    EXPECT_NEAR(c.k_min, -1 / r, 0.02 / r);
    EXPECT_NEAR(c.k_max, 0, 0.01 / r);
    EXPECT_NEAR(std::abs(c.direction_max.z()), 1, 1e-3);
  }
}

TEST(Curvature, TorusMatchesItsFormula) {
  const double R = 60, r = 20;
  const SurfaceMesh m = shapes::grid(240, 96, true, [&](double u, double v) {
    const double a = 2 * std::numbers::pi * u, w = R + r * std::cos(v);
    return Vec3(w * std::cos(a), w * std::sin(a), r * std::sin(v));
  });
  ASSERT_GT(signed_volume(m), 0);
  const auto all = curvature_by_radius(m, 4);
  for (std::size_t i = 0; i < m.points.size(); i += 5) {
    const double w = std::hypot(m.points[i].x(), m.points[i].y()), cosv = (w - R) / r;
    EXPECT_NEAR(all[i].gaussian, cosv / (r * w), 0.03 / (r * r));
    EXPECT_NEAR(all[i].mean, -0.5 * (1 / r + cosv / w), 0.02 / r);
  }
}

TEST(Curvature, QuadricsAreExactAtTheirFoot) {
  // Saddle, valley and slanted bowl: K and H by the formulas for graphs.
  struct Case {
    double a, b, c, p, q;  // z = a x^2 + b xy + c y^2 + p x + q y
  };
  for (const Case k :
       {Case{0.01, 0, -0.01, 0, 0}, {0.02, 0.01, 0.015, 0, 0}, {0.01, -0.02, 0.03, 0, 0}}) {
    const SurfaceMesh m = shapes::graph(10, 40, [&](double x, double y) {
      return k.a * x * x + k.b * x * y + k.c * y * y + k.p * x + k.q * y;
    });
    const Curvature c = curvature_by_neighbours(m)[middle(40)];
    EXPECT_NEAR(c.gaussian, 4 * k.a * k.c - k.b * k.b, 2e-6);
    EXPECT_NEAR(c.mean, k.a + k.c, 2e-5);
  }
}

TEST(Curvature, MovesWithTheMesh) {
  const SurfaceMesh m = shapes::graph(
      30, 30, [](double x, double y) { return 4 * std::sin(0.1 * x) + 0.01 * x * y; });
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const auto still = curvature_by_radius(m, 6.3);
  const auto moved = curvature_by_radius(transformed(m, turn, Vec3(5, 6, 7)), 6.3);
  const auto scaled =
      curvature_by_radius(transformed(m, 0.1 * Mat3::Identity(), Vec3::Zero()), 0.63);
  for (int j = 6; j < 25; ++j)
    for (int i = 6; i < 25; ++i) {
      const auto v = static_cast<std::size_t>(j * 31 + i);
      EXPECT_NEAR(moved[v].mean, still[v].mean, 1e-9);
      EXPECT_NEAR(moved[v].gaussian, still[v].gaussian, 1e-9);
      EXPECT_NEAR(scaled[v].mean, 10 * still[v].mean, 1e-9);
    }
}

TEST(Curvature, ThinSheetDoesNotMixItsSides) {
  // Two bowls back to back, 1 mm apart at the foot, as on an ear's rim.
  const auto bowl = [](double x, double y) { return -0.01 * (x * x + y * y); };
  SurfaceMesh m = shapes::graph(10, 40, bowl);
  SurfaceMesh back = m;
  for (Vec3& p : back.points) p.z() = -1;
  for (Triangle& t : back.triangles) std::swap(t[1], t[2]);
  shapes::append(m, back);
  EXPECT_NEAR(curvature_by_radius(m, 3)[middle(40)].mean, -0.02, 1e-4);
}

TEST(Curvature, SameBitsFromAnyNumberOfThreads) {
  const SurfaceMesh m = shapes::sphere(50, 5);
  std::vector<Curvature> run[2];
  for (int threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    run[threads - 1] = curvature_by_neighbours(m);
  }
  for (std::size_t i = 0; i < run[0].size(); ++i) {
    ASSERT_EQ(run[0][i].mean, run[1][i].mean);
    ASSERT_EQ(run[0][i].direction_max, run[1][i].direction_max);
  }
}

TEST(Curvature, RefusesWhatItCannotFit) {
  EXPECT_THROW((void)curvature_by_neighbours(shapes::cube(1), 5), InputError);
  EXPECT_THROW((void)curvature_by_radius(shapes::cube(1), 0), InputError);
  // All points on one line: no curvature, but no NaN either.
  SurfaceMesh line;
  for (int i = 0; i < 20; ++i) line.points.emplace_back(i, 0, 0);
  line.triangles = {{0, 1, 2}};
  for (const Curvature& c : curvature_by_neighbours(line, 10)) EXPECT_TRUE(std::isfinite(c.mean));
}

}  // namespace
}  // namespace palpate::surface
