// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/corner_mesh.hpp"

#include <gtest/gtest.h>

#include "closed.hpp"
#include "shapes.hpp"
#include "surface/point_tree.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;

// All that the editing functions promise to keep.
void expect_consistent(const CornerMesh& m) {
  std::vector<int> leaving(m.points.size(), 0);
  for (Id h = 0; h < m.half_edges(); ++h) {
    if (!m.alive(h)) continue;
    ++leaving[m.from(h)];
    const Id g = m.twin[h];
    if (g == CornerMesh::kNone) continue;
    ASSERT_TRUE(m.alive(g));
    ASSERT_EQ(m.twin[g], h);
    ASSERT_EQ(m.from(g), m.to(h));
    ASSERT_EQ(m.to(g), m.from(h));
  }
  for (std::size_t v = 0; v < m.points.size(); ++v) {
    if (leaving[v] == 0) continue;
    ASSERT_NE(m.out[v], CornerMesh::kNone);
    ASSERT_EQ(m.from(m.out[v]), static_cast<Id>(v));
    ASSERT_EQ(m.valence(static_cast<Id>(v)), leaving[v]) << "the walk sees the whole fan";
  }
}

TEST(CornerMesh, EditsKeepAClosedManifold) {
  CornerMesh m = corner_mesh(shapes::sphere(10, 3));
  for (int i = 0; i < 4000; ++i) {
    const auto pick = static_cast<double>(m.half_edges()) * 0.5 * (shapes::halton(i).x() + 1);
    const Id h = static_cast<Id>(pick);
    if (!m.alive(h)) continue;
    if (i % 3 == 0) m.split(h, 0.5 * (m.points[m.from(h)] + m.points[m.to(h)]));
    if (i % 3 == 1 && m.can_flip(h)) m.flip(h);
    if (i % 3 == 2 && m.can_collapse(h)) m.collapse(h);
    if (i % 100 == 0) expect_consistent(m);
  }
  m.compact();
  expect_consistent(m);
  const auto edges = m.half_edges() / 2;
  EXPECT_EQ(static_cast<Id>(m.points.size()) - edges + m.faces(), 2);  // Euler
}

TEST(CornerMesh, SplitsAndFlipsKeepABorder) {
  CornerMesh m = corner_mesh(shapes::graph(10, 6, [](double, double) { return 0.0; }));
  ASSERT_EQ(m.border_loops().size(), 1u);
  for (int i = 0; i < 600; ++i) {
    const Id h = static_cast<Id>(m.half_edges() * 0.5 * (shapes::halton(i).y() + 1));
    if (i % 2 == 0) m.split(h, 0.5 * (m.points[m.from(h)] + m.points[m.to(h)]));
    if (i % 2 == 1 && m.can_flip(h)) m.flip(h);
    if (i % 50 == 0) expect_consistent(m);
  }
  expect_consistent(m);
  const auto loops = m.border_loops();
  ASSERT_EQ(loops.size(), 1u);
  double length = 0;
  for (const Id h : loops[0]) length += std::sqrt(m.length2(h));
  EXPECT_NEAR(length, 80, 1e-9);
  Vec3 twice_area = Vec3::Zero();
  for (Id h = 0; h < m.half_edges(); h += 3) twice_area += m.area_vector(h);
  EXPECT_NEAR(twice_area.z(), 800, 1e-9);
}

TEST(CornerMesh, RemovingFacesLeavesOneManifoldPiece) {
  CornerMesh m = corner_mesh(shapes::sphere(10, 4));
  std::vector<std::uint8_t> gone(m.faces(), 0);
  for (Id f = 0; f < m.faces(); ++f) {
    Vec3 c = Vec3::Zero();
    for (Id h = 3 * f; h < 3 * f + 3; ++h) c += m.points[m.from(h)] / 3;
    gone[f] = std::abs(c.z() - 4) < 1 || f % 31 == 0;  // a band, and single faces that touch it
  }
  m.remove_faces(gone);
  expect_consistent(m);
  for (const Vec3& p : m.points) EXPECT_LT(p.z(), 3.5);  // the larger part
}

TEST(PointTree, EqualsExhaustiveSearch) {
  std::vector<Vec3> points;
  for (int i = 0; i < 3000; ++i) points.push_back(shapes::halton(i));
  for (int i = 0; i < 200; ++i) points.push_back(points[static_cast<std::size_t>(i)]);  // ties
  const PointTree tree(points);
  std::vector<PointTree::Neighbour> found, all(points.size());
  for (int q = 0; q < 50; ++q) {
    const Vec3 p = 1.2 * shapes::halton(5000 + q);
    for (std::size_t i = 0; i < points.size(); ++i)
      all[i] = {(points[i] - p).squaredNorm(), static_cast<std::int32_t>(i)};
    std::sort(all.begin(), all.end());
    tree.nearest(p, 40, found);
    ASSERT_EQ(found.size(), 40u);
    for (std::size_t i = 0; i < 40; ++i) ASSERT_EQ(found[i].point, all[i].point);
    tree.within(p, 0.3, found);
    const auto inside = std::count_if(all.begin(), all.end(),
                                      [](const auto& n) { return n.distance2 <= 0.3 * 0.3; });
    ASSERT_EQ(static_cast<std::ptrdiff_t>(found.size()), inside);
  }
  tree.nearest(Vec3::Zero(), 10'000, found);
  EXPECT_EQ(found.size(), points.size());
}

TEST(Intersections, SeesCrossingTouchingAndFolded) {
  EXPECT_TRUE(self_intersections(shapes::sphere(10, 3)).empty());
  EXPECT_TRUE(self_intersections(shapes::cube(10)).empty());
  SurfaceMesh two = shapes::cube(10), moved = shapes::cube(10);
  for (Vec3& p : moved.points) p += Vec3(5, 5, 5);
  shapes::append(two, moved);
  EXPECT_FALSE(self_intersections(two).empty());
  SurfaceMesh folded;  // two triangles on each other, joined at an edge
  folded.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.5, 0.5, 0)};
  folded.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(self_intersections(folded).size(), 1u);
  folded.points[3] = Vec3(0, -1, 0);
  EXPECT_TRUE(self_intersections(folded).empty());
  folded.points[3] = Vec3(2, 0, 0);  // no area
  EXPECT_EQ(self_intersections(folded).size(), 1u);
}

}  // namespace
}  // namespace palpate::surface
