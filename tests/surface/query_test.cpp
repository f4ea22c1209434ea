// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/query.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <limits>

#include "core/error.hpp"
#include "shapes.hpp"
#include "surface/triangle_geometry.hpp"

namespace palpate::surface {
namespace {

const Vec3 kFar(500, -800, 1200);  // [mm] away from the origin, where single precision is coarse

ClosestPoint brute_force(const SurfaceMesh& m, const Vec3& p) {
  ClosestPoint best;
  best.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < m.triangles.size(); ++i) {
    const auto& [a, b, c] = m.triangles[i];
    const TrianglePoint q = closest_on_triangle(p, m.points[a], m.points[b], m.points[c]);
    const double d = std::sqrt((q.point - p).squaredNorm());
    if (d < best.distance) best = {q.point, q.barycentric, static_cast<std::int32_t>(i), d};
  }
  return best;
}

TEST(Query, ClosestEqualsExhaustiveSearchToTheLastBit) {
  const SurfaceMesh m = shapes::sphere(100, 4, kFar);
  const SurfaceQuery query(m);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p = kFar + 180 * shapes::halton(i);
    const ClosestPoint found = query.closest(p), exact = brute_force(m, p);
    ASSERT_EQ(found.distance, exact.distance) << i;
    ASSERT_EQ(found.triangle, exact.triangle) << i;
    const Triangle& t = m.triangles[found.triangle];
    const Vec3 q = found.barycentric[0] * m.points[t[0]] + found.barycentric[1] * m.points[t[1]] +
                   found.barycentric[2] * m.points[t[2]];
    ASSERT_NEAR((q - found.point).norm(), 0, 1e-9);
  }
}

TEST(Query, TieGoesToTheLowestTriangle) {
  const SurfaceMesh m = shapes::sphere(10, 3);
  const SurfaceQuery query(m);
  for (std::size_t v = 0; v < m.points.size(); v += 7) {
    const ClosestPoint c = query.closest(m.points[v]);
    EXPECT_EQ(c.distance, 0);
    EXPECT_EQ(c.triangle, brute_force(m, m.points[v]).triangle);
  }
}

TEST(Query, NothingBeyondTheSearchRadius) {
  const SurfaceQuery query(shapes::sphere(10, 4));
  const Vec3 p(0, 0, 14);
  EXPECT_EQ(query.closest(p, 3.99).triangle, -1);
  EXPECT_TRUE(std::isinf(query.closest(p, 3.99).distance));
  EXPECT_NEAR(query.closest(p, 4.01).distance, 4, 1e-12);
  EXPECT_NEAR(query.closest(Vec3(0, 0, 5e7)).distance, 5e7 - 10, 1e-6);
}

TEST(Query, SignedDistanceOfASphere) {
  const SurfaceQuery query(shapes::sphere(1, 6, kFar));
  // The sagitta of the largest triangle bounds the difference to the smooth sphere.
  const double sagitta = 5e-4;
  for (int i = 0; i < 500; ++i) {
    const Vec3 offset = 2 * shapes::halton(i);
    EXPECT_NEAR(query.signed_distance(kFar + offset), offset.norm() - 1, sagitta);
  }
}

TEST(Query, SignedDistanceOfACubeAtFacesEdgesAndCorners) {
  const SurfaceQuery query(shapes::cube(1));
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = 2 * shapes::halton(i);
    const Vec3 q = p.cwiseAbs() - Vec3::Ones();
    const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    ASSERT_NEAR(query.signed_distance(p), exact, 1e-12) << p.transpose();
  }
}

TEST(Query, RayHitsTheSphereWhereTheFormulaSays) {
  const double r = 50;
  const SurfaceQuery query(shapes::sphere(r, 6, kFar));
  for (int i = 0; i < 500; ++i) {
    const Vec3 o = 1.5 * r * shapes::halton(i), d = shapes::halton(i + 1000).normalized();
    const double b = o.dot(d), disc = b * b - o.squaredNorm() + r * r;
    if (std::abs(disc) < 0.05 * r * r) continue;  // grazing: the facets decide
    const double near = -b - std::sqrt(std::max(0.0, disc)), far = 2 * -b - near;
    const auto hit = query.cast(kFar + o, d);
    const bool expected = disc > 0 && far > 0;
    ASSERT_EQ(hit.has_value(), expected) << i;
    if (!expected) continue;
    ASSERT_NEAR(hit->distance, near > 0 ? near : far, 0.2) << i;
    ASSERT_NEAR((kFar + o + hit->distance * d - hit->point).norm(), 0, 1e-9);
    ASSERT_NEAR(query.closest(hit->point).distance, 0, 1e-9);
  }
}

TEST(Query, RayWindowIsExactInDouble) {
  const SurfaceQuery query(shapes::cube(1));
  const Vec3 o(0.3, 0.2, -5), d(0, 0, 1);
  EXPECT_DOUBLE_EQ(query.cast(o, d)->distance, 4);
  EXPECT_DOUBLE_EQ(query.cast(o, d, 1e9, 4)->distance, 6);  // beyond, not at, the minimum
  EXPECT_DOUBLE_EQ(query.cast(o, d, 1e9, 4 - 1e-12)->distance, 4);
  EXPECT_FALSE(query.cast(o, d, 4 - 1e-12).has_value());
  EXPECT_FALSE(query.cast(o, d, 1e9, 6).has_value());
  EXPECT_FALSE(query.cast(o, -d).has_value());
}

TEST(Query, NoRayLeaksThroughAnEdgeOrCorner) {
  const SurfaceMesh m = shapes::sphere(100, 4, kFar);
  const SurfaceQuery query(m);
  for (std::size_t v = 0; v < m.points.size(); ++v) {
    const auto hit = query.cast(kFar, (m.points[v] - kFar).normalized());
    ASSERT_TRUE(hit.has_value()) << v;
    ASSERT_NEAR(hit->distance, 100, 1e-9);
  }
  for (const Triangle& t : m.triangles) {
    const Vec3 mid = 0.5 * (m.points[t[0]] + m.points[t[1]]) - kFar;
    const auto hit = query.cast(kFar, mid.normalized());
    ASSERT_TRUE(hit.has_value());
    ASSERT_NEAR(hit->distance, mid.norm(), 1e-9);
  }
}

TEST(Query, RayFromTheSurfaceSeesWhatLiesBeyondTheMinimum) {
  const SurfaceMesh m = shapes::sphere(100, 5, kFar);
  const SurfaceQuery query(m);
  for (std::size_t v = 0; v < m.points.size(); ++v) {
    const Vec3 inward = (kFar - m.points[v]).normalized();
    const auto self = query.cast(m.points[v] - 1e-9 * inward, inward);
    ASSERT_TRUE(self.has_value());
    ASSERT_NEAR(self->distance, 1e-9, 1e-10) << v;  // far below single precision at this distance
    ASSERT_GT(query.cast(m.points[v], inward, 1e9, 1e-6)->distance, 199.8);
  }
}

TEST(Query, SameBitsFromManyThreads) {
  const SurfaceMesh m = shapes::sphere(100, 5, kFar);
  std::array<std::vector<double>, 2> run;
  for (int threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SurfaceQuery query(m);
    auto& out = run[threads - 1];
    out.resize(20000);
    tbb::parallel_for(0, 10000, [&](int i) {
      const Vec3 p = kFar + 150 * shapes::halton(i);
      out[2 * i] = query.signed_distance(p);
      const auto hit = query.cast(p, (kFar - p).normalized());
      out[2 * i + 1] = hit ? hit->distance + hit->triangle : -1;
    });
  }
  EXPECT_EQ(run[0], run[1]);
}

TEST(Query, DegenerateTrianglesAreTheirEdges) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), c(1, 0, 0);
  EXPECT_NEAR((closest_on_triangle({1.5, 1, 0}, a, b, c).point - Vec3(1.5, 0, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((closest_on_triangle({5, 1, 0}, a, a, a).point - a).norm(), 0, 1e-15);
}

TEST(Query, RefusesUnusableMeshes) {
  EXPECT_THROW(SurfaceQuery(SurfaceMesh{}), InputError);
  SurfaceMesh m = shapes::cube(1);
  m.points[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SurfaceQuery{m}, InputError);
  m = shapes::cube(1);
  m.triangles[2][1] = 8;
  EXPECT_THROW(SurfaceQuery{m}, InputError);
}

}  // namespace
}  // namespace palpate::surface
