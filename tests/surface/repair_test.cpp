// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/repair.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "closed.hpp"
#include "core/error.hpp"
#include "shapes.hpp"
#include "surface/query.hpp"
#include "surface/wrap.hpp"

namespace palpate::surface {
namespace {

constexpr double kPi = std::numbers::pi;
double ball(double r) {
  return 4 * kPi / 3 * r * r * r;
}

// A body of revolution about z; the profile runs from the lower pole to the upper one.
SurfaceMesh revolve(const std::vector<std::pair<double, double>>& profile, int around) {
  const int n = static_cast<int>(profile.size()) - 1;
  return shapes::grid(n, around, false, [&](double u, double v) {
    const auto [r, z] = profile[static_cast<std::size_t>(std::lround(u * n))];
    return Vec3(r * std::cos(-v), r * std::sin(-v), z);
  });
}
void arc(std::vector<std::pair<double, double>>& profile, double radius, double z, double from,
         double to, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const double a = from + (to - from) * i / steps;
    profile.emplace_back(std::max(0.0, radius * std::cos(a)), z + radius * std::sin(a));
  }
}

TEST(Repair, SphereStaysASphere) {
  const WorkingSurface w = make_working_surface(shapes::sphere(60, 5, Vec3(100, 700, -50)));
  expect_clean(w.mesh);
  EXPECT_NEAR(signed_volume(w.mesh) / ball(60), 1, 2e-3);
  for (const Vec3& p : w.mesh.points) EXPECT_NEAR((p - Vec3(100, 700, -50)).norm(), 60, 0.15);
  for (const auto& [a, b, c] : w.mesh.triangles) {
    EXPECT_GT((w.mesh.points[b] - w.mesh.points[a]).norm(), 1.5);
    EXPECT_LT((w.mesh.points[b] - w.mesh.points[a]).norm(), 4.5);
  }
  for (const auto f : w.filled) EXPECT_EQ(f, 0);
  EXPECT_LT(w.report.deviation_p95_mm, 0.05);
  EXPECT_EQ(w.report.holes_filled + w.report.pockets_closed + w.report.nonmanifold_spots, 0u);
  EXPECT_EQ(w.report.components, 1u);
  EXPECT_FALSE(w.report.winding_inverted || w.report.wrapped);
}

TEST(Repair, CubeKeepsItsVolume) {
  const WorkingSurface w = make_working_surface(shapes::cube(50));
  expect_clean(w.mesh);
  EXPECT_NEAR(signed_volume(w.mesh), 1e6, 1e4);
}

TEST(Repair, EdgeLengthIsTheOptions) {
  for (const double edge : {2.0, 5.0}) {
    RepairOptions options;
    options.target_edge = edge;
    const WorkingSurface w = make_working_surface(shapes::sphere(60, 5), options);
    expect_clean(w.mesh);
    const double mean_area = area(w.mesh) / static_cast<double>(w.mesh.triangles.size());
    EXPECT_NEAR(std::sqrt(mean_area * 4 / std::sqrt(3)), edge, 0.15 * edge);
  }
}

TEST(Repair, OpenSphereIsCappedFlat) {
  std::vector<std::pair<double, double>> profile;
  arc(profile, 60, 0, std::asin(-40.0 / 60), kPi / 2, 60);
  const SurfaceMesh m = revolve(profile, 120);
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.holes_filled, 1u);
  EXPECT_NEAR(w.report.largest_hole_mm, 2 * kPi * std::sqrt(60 * 60 - 40 * 40), 1);
  const double h = 20;  // of the segment that is missing
  EXPECT_NEAR(signed_volume(w.mesh), ball(60) - kPi * h * h * (60 - h / 3), 3e-3 * ball(60));
  std::size_t filled = 0;
  for (std::size_t v = 0; v < w.mesh.points.size(); ++v) {
    const Vec3& p = w.mesh.points[v];
    if (p.norm() < 58) {
      EXPECT_TRUE(w.filled[v]) << p.transpose();
    }
    if (p.z() > -39) {
      EXPECT_FALSE(w.filled[v]) << p.transpose();
    }
    filled += w.filled[v];
  }
  EXPECT_GT(filled, 300u);
}

TEST(Repair, SoupOfFacetsEqualsTheMesh) {
  const SurfaceMesh m = shapes::sphere(60, 4);
  SurfaceMesh soup;  // as from STL, with some facets twice and some without area
  for (std::size_t i = 0; i < m.triangles.size(); ++i)
    for (int copy = 0; copy < (i % 100 == 0 ? 2 : 1); ++copy) {
      const auto n = static_cast<std::int32_t>(soup.points.size());
      for (int k = 0; k < 3; ++k) soup.points.push_back(m.points[m.triangles[i][(k + copy) % 3]]);
      soup.triangles.push_back({n, n + 1, n + 2});
      if (i % 50 == 0) soup.triangles.push_back({n, n, n + 1});
    }
  soup.points[7] += Vec3(1e-4, -1e-4, 1e-4);  // not quite the same number
  const WorkingSurface a = make_working_surface(m), b = make_working_surface(soup);
  expect_clean(b.mesh);
  EXPECT_EQ(b.report.duplicate_points, soup.points.size() - m.points.size());
  EXPECT_EQ(b.report.duplicate_faces, 21u);   // 0, 100, ... 2000 of 2048
  EXPECT_EQ(b.report.degenerate_faces, 62u);  // 41, of which 21 twice
  EXPECT_EQ(b.report.nonmanifold_spots, 0u);
  EXPECT_EQ(b.report.components, 1u);
  EXPECT_NEAR(signed_volume(a.mesh), signed_volume(b.mesh), 1e-4 * ball(60));
}

TEST(Repair, WindingIsTurnedOutward) {
  SurfaceMesh inside_out = shapes::sphere(60, 4);
  for (Triangle& t : inside_out.triangles) std::swap(t[1], t[2]);
  const WorkingSurface a = make_working_surface(inside_out);
  expect_clean(a.mesh);
  EXPECT_TRUE(a.report.winding_inverted);

  SurfaceMesh mixed = shapes::sphere(60, 4);
  for (std::size_t i = 0; i < mixed.triangles.size(); i += 3)
    std::swap(mixed.triangles[i][0], mixed.triangles[i][1]);
  const WorkingSurface b = make_working_surface(mixed);
  expect_clean(b.mesh);
  EXPECT_FALSE(b.report.winding_inverted);
  EXPECT_EQ(b.report.holes_filled, 0u);
}

TEST(Repair, LargestPieceIsKept) {
  SurfaceMesh m = shapes::sphere(20, 4, Vec3(120, 0, 0));
  shapes::append(m, shapes::sphere(60, 3));
  shapes::append(m, shapes::sphere(30, 2));  // inside
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.components, 3u);
  EXPECT_EQ(w.report.dropped_triangles, 8u * 256 + 8 * 16);
  EXPECT_LT(bounding_box(w.mesh.points).high.x(), 61);
}

TEST(Repair, BowTieIsTakenApart) {
  SurfaceMesh m = shapes::sphere(60, 4);
  const SurfaceMesh other = shapes::sphere(30, 3, Vec3(90, 0, 0));
  shapes::append(m, other);  // (60, 0, 0) is point 0 of one and point 1 of the other
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.duplicate_points, 1u);
  EXPECT_EQ(w.report.components, 2u);
  EXPECT_NEAR(signed_volume(w.mesh) / ball(60), 1, 0.01);
}

TEST(Repair, FinsAndSharedEdgesAreTakenApart) {
  SurfaceMesh m = shapes::sphere(60, 4);
  const auto n = static_cast<std::int32_t>(m.points.size());
  m.points.push_back(1.2 * m.points[m.triangles[5][0]]);
  m.triangles.push_back({m.triangles[5][0], m.triangles[5][1], n});  // a third face at an edge
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.nonmanifold_spots, 1u);
  EXPECT_EQ(w.report.dropped_triangles, 1u);
  EXPECT_EQ(w.report.holes_filled, 0u);  // the two flat faces stay together

  SurfaceMesh twins = shapes::cube(30), right = shapes::cube(30);  // joined along one edge
  for (Vec3& p : right.points) p += Vec3(60, 60, 0);
  shapes::append(twins, right);
  const WorkingSurface t = make_working_surface(twins);
  expect_clean(t.mesh);
  EXPECT_EQ(t.report.components, 2u);
  EXPECT_NEAR(signed_volume(t.mesh), 60.0 * 60 * 60, 0.02 * 60 * 60 * 60);
}

TEST(Repair, ManySmallHolesAndOneTornSeam) {
  SurfaceMesh m = shapes::sphere(60, 5);
  std::size_t i = 0;
  std::erase_if(m.triangles, [&](const Triangle&) { return i++ % 97 == 0; });
  SurfaceMesh torn = m;  // all faces of one octant get points of their own, moved by 0.05 mm
  for (Triangle& t : torn.triangles) {
    const Vec3 c = m.points[t[0]] + m.points[t[1]] + m.points[t[2]];
    if (c.minCoeff() < 0) continue;
    for (std::int32_t& v : t) {
      torn.points.push_back(m.points[v] + Vec3(0.05, 0, 0));
      v = static_cast<std::int32_t>(torn.points.size()) - 1;
    }
  }
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.holes_filled, 83u);  // of 85, two pairs are neighbours
  EXPECT_NEAR(signed_volume(w.mesh) / ball(60), 1, 3e-3);
  const WorkingSurface v = make_working_surface(torn);  // the octant is a piece of its own
  expect_clean(v.mesh);
  EXPECT_EQ(v.report.components, 2u);
}

TEST(Repair, NarrowMouthedPocketIsClosed) {
  // A ball of radius 80 with a chamber of radius 30 that opens at the top through a neck of 6 mm.
  std::vector<std::pair<double, double>> profile;
  arc(profile, 80, 0, -kPi / 2, std::acos(6.0 / 80), 80);
  const double floor = 35, roof = floor + std::sqrt(30 * 30 - 6 * 6);
  for (double z = 78; z > roof; z -= 3) profile.emplace_back(6, z);
  arc(profile, 30, floor, std::acos(6.0 / 30), -kPi / 2, 40);
  const SurfaceMesh m = revolve(profile, 90);
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.pockets_closed, 1u);
  EXPECT_NEAR(signed_volume(w.mesh) / ball(80), 1, 5e-3);
  EXPECT_LT(w.report.deviation_p95_mm, 0.3);
  EXPECT_GT(w.report.deviation_all_p95_mm, 20);
}

TEST(Repair, ShallowDentIsSkin) {
  std::vector<std::pair<double, double>> profile;
  arc(profile, 80, 0, -kPi / 2, kPi / 3, 80);  // a bowl of radius 40 mm and 20 mm depth on top
  const double rim = 40, z = 80 * std::sin(kPi / 3);
  for (int i = 1; i <= 30; ++i)
    profile.emplace_back(rim * (1 - i / 30.0), z - 20 * (1 - (1 - i / 30.0) * (1 - i / 30.0)));
  const SurfaceMesh m = revolve(profile, 90);
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.pockets_closed, 0u);
  EXPECT_NEAR(SurfaceQuery(w.mesh).signed_distance(Vec3(0, 0, z - 20)), 0, 0.5);
}

TEST(Repair, SurfaceThroughItselfComesOutClean) {
  // A spindle torus: R < r, so that the tube passes through itself around the axis.
  const SurfaceMesh m = shapes::grid(90, 90, true, [](double u, double v) {
    const double a = 2 * kPi * u, w = 30 + 60 * std::cos(v);
    return Vec3(w * std::cos(a), w * std::sin(a), 60 * std::sin(v));
  });
  ASSERT_GT(self_intersections(m).size(), 100u);
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  const SurfaceQuery query(w.mesh);
  EXPECT_NEAR(query.signed_distance(Vec3(90, 0, 0)), 0, 1.5);
  EXPECT_NEAR(query.signed_distance(Vec3(30, 0, 60)), 0, 1.5);
}

TEST(Repair, WrapIsTheOuterSkinOfAnything) {
  SurfaceMesh m = shapes::sphere(30, 3);
  shapes::append(m, shapes::sphere(30, 3, Vec3(30, 0, 0)));
  std::erase_if(m.triangles, [n = 0](const Triangle&) mutable { return n++ % 50 == 0; });
  const SurfaceMesh w = alpha_wrap(m, 10, 0.3);
  expect_clean(w);
  const SurfaceQuery query(w);
  for (const Vec3& p : {Vec3(-30, 0, 0), Vec3(60, 0, 0), Vec3(0, 30, 0), Vec3(30, 0, -30)})
    EXPECT_NEAR(query.signed_distance(p), 0, 1);
  EXPECT_LT(query.signed_distance(Vec3(15, 0, 0)), -20);
}

TEST(Repair, RefusesToGuessAtARuin) {
  SurfaceMesh m = shapes::sphere(60, 4);  // points 12 mm off, edges of 6 mm
  for (std::size_t v = 0; v < m.points.size(); ++v)
    m.points[v] += 12 * shapes::halton(static_cast<int>(v));
  EXPECT_THROW((void)make_working_surface(m), InputError);
}

TEST(Repair, NoiseOfAnEdgeLengthGoesThrough) {
  SurfaceMesh m = shapes::sphere(60, 5);
  for (std::size_t v = 0; v < m.points.size(); ++v)
    m.points[v] += 2 * shapes::halton(static_cast<int>(v));
  ASSERT_GT(self_intersections(m).size(), 100u);
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_NEAR(signed_volume(w.mesh) / ball(60), 1, 5e-3);
}

TEST(Repair, OnePointPushedThroughTheSkinIsPulledBack) {
  SurfaceMesh m = shapes::sphere(60, 5);
  for (std::size_t v = 0; v < m.points.size(); v += 500) m.points[v] *= -0.9;
  const WorkingSurface w = make_working_surface(m);
  expect_clean(w.mesh);
  EXPECT_FALSE(w.report.wrapped);
  EXPECT_LT(w.report.deviation_p95_mm, 0.3);
}

TEST(Repair, LargeScansAreThinnedAndReported) {
  RepairOptions options;
  options.decimate_above = 10'000;
  const SurfaceMesh m = shapes::sphere(60, 6);
  const WorkingSurface w = make_working_surface(m, options);
  expect_clean(w.mesh);
  EXPECT_EQ(w.report.decimated_from, m.triangles.size());
  EXPECT_LT(w.report.deviation_p95_mm, 0.05);
  options.refuse_above = 20'000;
  EXPECT_THROW((void)make_working_surface(m, options), InputError);
}

TEST(Repair, MovesWithTheScan) {
  const SurfaceMesh m =
      transformed(shapes::sphere(1, 5), Vec3(60, 90, 70).asDiagonal(), Vec3::Zero());
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, -2, 3).normalized()).toRotationMatrix();
  const WorkingSurface a = make_working_surface(m);
  const WorkingSurface b = make_working_surface(transformed(m, turn, Vec3(5, 900, -20)));
  EXPECT_NEAR(signed_volume(a.mesh), signed_volume(b.mesh), 1e-4 * signed_volume(a.mesh));
}

TEST(Repair, SameBitsFromAnyNumberOfThreads) {
  SurfaceMesh m = shapes::sphere(60, 5);
  std::erase_if(m.triangles, [&](const Triangle& t) { return m.points[t[0]].z() < -40; });
  WorkingSurface run[2];
  for (int threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    run[threads - 1] = make_working_surface(m);
  }
  EXPECT_EQ(run[0].mesh.points, run[1].mesh.points);
  EXPECT_EQ(run[0].mesh.triangles, run[1].mesh.triangles);
  EXPECT_EQ(run[0].filled, run[1].filled);
  EXPECT_EQ(run[0].report.lines, run[1].report.lines);
}

TEST(Repair, StopsWhenAsked) {
  std::atomic<bool> stop{true};
  EXPECT_THROW((void)make_working_surface(shapes::sphere(60, 3), {}, Progress(nullptr, &stop)),
               Cancelled);
}

std::string refusal(const SurfaceMesh& m, const RepairOptions& options = {}) {
  try {
    (void)make_working_surface(m, options);
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return "";
}

TEST(Repair, RefusesWhatHasNoInside) {
  EXPECT_NE(refusal({}), "");
  SurfaceMesh points = shapes::sphere(60, 3);
  for (Vec3& p : points.points) p = Vec3(1, 2, 3);
  EXPECT_NE(refusal(points).find("coincide"), std::string::npos);
  SurfaceMesh single;
  single.points = {Vec3(0, 0, 0), Vec3(100, 0, 0), Vec3(0, 100, 0)};
  single.triangles = {{0, 1, 2}};
  EXPECT_NE(refusal(single).find("volume"), std::string::npos);
  const auto flat = [](double, double) { return 0.0; };
  EXPECT_NE(refusal(shapes::graph(100, 30, flat)).find("volume"), std::string::npos);
  SurfaceMesh line = shapes::graph(100, 30, flat);
  for (Vec3& p : line.points) p.y() = 0;
  EXPECT_NE(refusal(line), "");
}

TEST(Repair, RefusesDamagedNumbersAndWrongUnits) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  SurfaceMesh m = shapes::sphere(60, 3);
  m.points[17].y() = inf - inf;
  EXPECT_NE(refusal(m).find("vertex 17"), std::string::npos);
  m.points[17].y() = inf;
  EXPECT_NE(refusal(m).find("vertex 17"), std::string::npos);
  m.points[17].y() = 0;
  m.triangles[3][1] = -1;
  EXPECT_NE(refusal(m).find("triangle 3"), std::string::npos);
  EXPECT_NE(refusal(shapes::sphere(0.06, 4)).find("unit"), std::string::npos);
  EXPECT_NE(refusal(shapes::sphere(60'000, 4)).find("unit"), std::string::npos);
  EXPECT_NE(refusal(shapes::sphere(1e200, 4)), "");
  EXPECT_NE(refusal(shapes::sphere(1e-200, 4)), "");
  RepairOptions options;
  options.target_edge = 0;
  EXPECT_NE(refusal(shapes::sphere(60, 3), options).find("edge"), std::string::npos);
}

}  // namespace
}  // namespace palpate::surface
