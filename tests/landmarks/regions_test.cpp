// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/regions.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "heads.hpp"
#include "landmarks/face_model.hpp"

namespace palpate::landmarks {
namespace {

LandmarkSet mean_landmarks() {
  LandmarkSet set;
  for (const auto& [name, p] : face_model().marks) set[name] = {p, 1};
  return set;
}

SkinRegion region_of(const Vec3& p, const Vec3& normal = Vec3::UnitZ()) {
  return skin_regions({p}, {normal}, mean_landmarks())[0];
}

// Anatomy on the mean face; places in [mm] of its head frame.
TEST(SkinRegions, PlacesOfTheMeanFace) {
  EXPECT_EQ(region_of({0, 60, 5}), SkinRegion::forehead);
  EXPECT_EQ(region_of({0, 110, -70}), SkinRegion::cranium);
  EXPECT_EQ(region_of({0, 20, -160}), SkinRegion::cranium);
  EXPECT_EQ(region_of({30, 20, 8}), SkinRegion::eyebrow);
  EXPECT_EQ(region_of({45, -22, -5}), SkinRegion::cheekbone);
  EXPECT_EQ(region_of({65, -14, -45}), SkinRegion::cheekbone);
  EXPECT_EQ(region_of({45, -52, -15}), SkinRegion::cheek);
  EXPECT_EQ(region_of({0, -95, 12}), SkinRegion::chin);
  EXPECT_EQ(region_of({40, -88, -25}), SkinRegion::jaw);
  EXPECT_EQ(region_of({58, -72, -58}), SkinRegion::jaw);
  EXPECT_EQ(region_of({60, -45, -56}), SkinRegion::other);  // the masseter over the ramus
  EXPECT_EQ(region_of({0, -108, 6}), SkinRegion::jaw);
  EXPECT_EQ(region_of({28, 0, 3}), SkinRegion::eye);
  EXPECT_EQ(region_of({0, -37, 33}), SkinRegion::nose);
  EXPECT_EQ(region_of({0, -64, 20}), SkinRegion::lips);
  EXPECT_EQ(region_of({78, -16, -85}), SkinRegion::ear);
  EXPECT_EQ(region_of({0, -140, -40}), SkinRegion::neck);
}

TEST(SkinRegions, ACutThroughTheFaceIsNoRegion) {
  EXPECT_EQ(region_of({40, -55, -20}, -Vec3::UnitY()), SkinRegion::other);
}

TEST(SkinRegions, SymmetricForSymmetricLandmarks) {
  std::vector<Vec3> points, mirrored, normals;
  for (double x = 1; x < 90; x += 4)
    for (double y = -130; y < 120; y += 4)
      for (double z = -170; z < 40; z += 8) {
        points.emplace_back(x, y, z);
        mirrored.emplace_back(-x, y, z);
        normals.push_back(Vec3::UnitZ());
      }
  EXPECT_EQ(skin_regions(points, normals, mean_landmarks()),
            skin_regions(mirrored, normals, mean_landmarks()));
}

TEST(SkinRegions, AllSevenOnTheBundledHeadAndAboutAsLargeOnBothSides) {
  const KnownHead& head = bundled_head();
  const Detection found = detect_landmarks(head.skin);
  LandmarkSet marks = found.landmarks;
  for (auto& [name, m] : marks) m.position = found.frame.to_head(m.position);
  const HeadFrame& f = found.frame;
  const SurfaceMesh skin = transformed(head.skin, f.rotation, -(f.rotation * f.origin));
  const auto regions = skin_regions(skin.points, vertex_normals(skin), marks);
  for (const SkinRegion wanted : kPublishedOrder) {
    int left = 0, right = 0;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      if (regions[i] == wanted) ++(skin.points[i].x() > 0 ? left : right);
    }
    EXPECT_GT(left + right, 150) << name(wanted);
    EXPECT_NEAR(left, right, 0.15 * (left + right)) << name(wanted);
  }
}

// The five published points alone carry the regions, only less closely.
TEST(SkinRegions, FivePointsAreEnough) {
  LandmarkSet five;
  for (const char* name :
       {"nose_tip", "nose_corner_left", "nose_corner_right", "eye_outer_left", "eye_outer_right"}) {
    five[name] = mean_landmarks().at(name);
  }
  EXPECT_EQ(skin_regions({{0, -95, 12}}, {Vec3::UnitZ()}, five)[0], SkinRegion::chin);
  EXPECT_THROW((void)skin_regions({{0, 0, 0}}, {}, five), InputError);
}

}  // namespace
}  // namespace palpate::landmarks
