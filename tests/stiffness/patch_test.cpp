// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/patch.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "fem/tet_mesh.hpp"
#include "scenes.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/site_features.hpp"

namespace palpate::stiffness {
namespace {

fem::TetMesh mesh_of(const PatchTemplate& t, const std::vector<Vec3>& nodes) {
  return {fem::ElementOrder::quadratic, nodes, t.topology.tets};
}

TEST(PatchTemplate, IsConformingAndCoversTheDisk) {
  for (const int layers : {1, 2, 3}) {
    const PatchTemplate t = make_template(default_rule(8, 43, layers));
    PatchGeometry flat;
    flat.height.assign(t.columns.size(), 0.0);
    flat.thickness.assign(t.columns.size(), 6.0);
    const fem::TetMesh mesh = mesh_of(t, patch_nodes(t, flat, 2.5));
    double volume = 0;
    for (int i = 0; i < mesh.size(); ++i) volume += fem::corner_volume(mesh, i);
    const int rim = t.rule.rings.back().sectors;
    const double polygon = 0.5 * rim * 43 * 43 * std::sin(2 * std::numbers::pi / rim);
    EXPECT_NEAR(volume, 6 * polygon, 1e-6 * volume);
    // Faces met once: two disks of triangles and the rim's quadrilaterals, two triangles each.
    const std::size_t disk = 2 * (t.columns.size() - 1) - rim;
    EXPECT_EQ(fem::boundary_faces(mesh).size() / 6, 2 * disk + 2 * rim * layers);
  }
}

// Columns are parallel, so no skin and no bone can invert an element.
TEST(PatchTemplate, AnyHeightsAndThicknessesGivePositiveVolumes) {
  const PatchTemplate t = make_template(rule_for_depth(20, 8));
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> height(-40, 40), thickness(1, 40);
  PatchGeometry wild;
  for (std::size_t i = 0; i < t.columns.size(); ++i) {
    wild.height.push_back(height(random));
    wild.thickness.push_back(thickness(random));
  }
  const fem::TetMesh mesh = mesh_of(t, patch_nodes(t, wild, 2.5));
  for (int i = 0; i < mesh.size(); ++i) EXPECT_GT(fem::corner_volume(mesh, i), 0);
}

TEST(SamplePatch, FindsSkinAndBoneOfConcentricSpheres) {
  const surface::SurfaceQuery skin(scenes::ellipsoid(5, Vec3::Constant(90)));
  const surface::SurfaceQuery bone(scenes::ellipsoid(5, Vec3::Constant(84)));
  const PatchTemplate t = make_template(rule_for_depth(6, 8));
  const Vec3 n = Vec3(1, 2, 3).normalized();
  const PatchGeometry g = sample_patch(t.columns, 8, site_frame(90 * n, n), skin, bone);
  EXPECT_EQ(g.bent + g.bent_far + g.boneless, 0);
  for (std::size_t i = 0; i < t.columns.size(); ++i) {
    const double r2 = t.columns[i].x * t.columns[i].x + t.columns[i].y * t.columns[i].y;
    EXPECT_NEAR(g.height[i], std::sqrt(90 * 90 - r2) - 90, 0.1);
    EXPECT_NEAR(g.thickness[i], std::sqrt(90 * 90 - r2) - std::sqrt(84 * 84 - r2), 0.15);
  }
}

// A ball beside the site stands in the way of rays that come from far above; the march does not
// take its top for the skin.
TEST(SamplePatch, CutsOffWhatIsNoHeightField) {
  SurfaceMesh both = scenes::ellipsoid(5, Vec3::Constant(90));
  SurfaceMesh ball = scenes::ellipsoid(3, Vec3::Constant(12), Vec3(0, 25, 97));
  for (Triangle& tri : ball.triangles)
    for (auto& v : tri) v += static_cast<std::int32_t>(both.points.size());
  both.points.insert(both.points.end(), ball.points.begin(), ball.points.end());
  both.triangles.insert(both.triangles.end(), ball.triangles.begin(), ball.triangles.end());
  const surface::SurfaceQuery skin(both), bone(scenes::ellipsoid(5, Vec3::Constant(84)));
  const PatchTemplate t = make_template(rule_for_depth(6, 8));
  const PatchGeometry g =
      sample_patch(t.columns, 8, site_frame(Vec3(0, 0, 90), Vec3::UnitZ()), skin, bone);
  EXPECT_EQ(g.bent, 0);
  for (std::size_t i = 0; i < t.columns.size(); ++i) {
    EXPECT_GT(g.thickness[i], 0);
    const Column& c = t.columns[i];
    if (c.ring > 0)
      EXPECT_LE(std::abs(g.height[i] - g.height[c.inner]),
                1.6 * std::hypot(c.x - t.columns[c.inner].x, c.y - t.columns[c.inner].y) + 0.1);
  }
}

TEST(SmoothedNormals, IgnoreNoiseOnASphere) {
  SurfaceMesh m = scenes::ellipsoid(5, Vec3::Constant(90));
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> d(-0.15, 0.15);
  std::vector<Vec3> true_normals;
  for (Vec3& p : m.points) {
    true_normals.push_back(p.normalized());
    p *= 1 + d(random) / 90;
  }
  const std::vector<Vec3> smooth = smoothed_normals(m, 8), raw = vertex_normals(m);
  double worst = 0, worst_raw = 0;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    worst = std::max(worst, (smooth[i] - true_normals[i]).norm());
    worst_raw = std::max(worst_raw, (raw[i] - true_normals[i]).norm());
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(worst, 0.5 * worst_raw);
}

TEST(SiteFrame, IsARightHandedFrameOnTheNormal) {
  for (const Vec3& n : {Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, -2, 0.5), Vec3(0.01, -1, 0)}) {
    const SiteFrame f = site_frame(Vec3::Zero(), n);
    EXPECT_NEAR(f.axes.determinant(), 1, 1e-12);
    EXPECT_LT((f.axes.transpose() * f.axes - Mat3::Identity()).norm(), 1e-12);
    EXPECT_LT((f.normal() - n.normalized()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace palpate::stiffness
