// SPDX-License-Identifier: Apache-2.0
#include "core/surface_mesh.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace palpate {
namespace {

SurfaceMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TEST(SurfaceMesh, VolumeOfATetrahedronIsOneSixthWhereverItLies) {
  const SurfaceMesh mesh = tetrahedron();
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-15);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_NEAR(signed_volume(transformed(mesh, turn, Vec3(1e4, -2e4, 3e4))), 1.0 / 6, 1e-9);
  EXPECT_NEAR(signed_volume(transformed(mesh, -Mat3::Identity(), Vec3::Zero())), -1.0 / 6, 1e-15);
}

TEST(SurfaceMesh, AngleWeightedNormalsDoNotDependOnTheTriangulation) {
  // A flat-topped corner cut into one or two triangles has the same normal.
  SurfaceMesh one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}};
  SurfaceMesh two = one;
  two.points.push_back({0.5, 0.5, 0});
  two.triangles = {{0, 1, 4}, {0, 4, 2}, {0, 2, 3}, {0, 3, 1}};
  EXPECT_LT((vertex_normals(one)[0] - vertex_normals(two)[0]).norm(), 1e-14);
}

TEST(SurfaceMesh, NamesTheFirstDefect) {
  SurfaceMesh mesh = tetrahedron();
  EXPECT_FALSE(first_defect(mesh));
  mesh.triangles[2][1] = 9;
  EXPECT_EQ(*first_defect(mesh), "triangle 2 names vertex 9, but there are 4 vertices");
  mesh.points[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(*first_defect(mesh), "vertex 3 has a NaN or infinite coordinate");
}

}  // namespace
}  // namespace palpate
