// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/carriers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"
#include "stiffness/site_features.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kPatch = 17;  // [mm] radius of a painted region

/// A head whose left eye (or nose) is the skin around `middle`.
scenes::Head head_with(SkinRegion region, const Vec3& middle) {
  scenes::Head h = scenes::head(5);
  for (std::size_t p = 0; p < h.skin.skin.points.size(); ++p)
    if ((h.skin.skin.points[p] - middle).norm() < kPatch) h.skin.region[p] = region;
  return h;
}
const Vec3 kEye = {35, 25, 76.5};   // on the skin: (35/75)^2 + (25/100)^2 + (76.5/90)^2 = 1
const Vec3 kTip = {0, -20, 88.18};  // likewise

std::size_t nearest(const scenes::Head& h, const Vec3& to) {
  std::size_t best = 0;
  for (std::size_t p = 0; p < h.skin.skin.points.size(); ++p)
    if ((h.skin.skin.points[p] - to).norm() < (h.skin.skin.points[best] - to).norm()) best = p;
  return best;
}

TEST(Carriers, TheGlobeTouchesTheLidFromBehindAndNowhereComesNearer) {
  const scenes::Head h = head_with(SkinRegion::eye, kEye);
  const OrganOptions o;
  const Carriers carriers(h.skin, h.skull, o);
  const std::size_t bone = h.skull.mesh.points.size();
  const auto& points = carriers.query().mesh().points;
  ASSERT_GT(points.size(), bone);
  Vec3 centre = Vec3::Zero();
  for (std::size_t p = bone; p < points.size(); ++p)
    centre += points[p] / static_cast<double>(points.size() - bone);
  for (std::size_t p = bone; p < points.size(); ++p)
    EXPECT_NEAR((points[p] - centre).norm(), o.globe_radius, 1e-9);
  double least = 1e9;
  for (std::size_t p = 0; p < h.skin.skin.points.size(); ++p)
    if (h.skin.region[p] == SkinRegion::eye)
      least = std::min(least, (h.skin.skin.points[p] - centre).norm() - o.globe_radius);
  EXPECT_NEAR(least, o.lid, 1e-9);
}

TEST(Carriers, TheGlobesFacesLookOutwards) {
  const scenes::Head h = head_with(SkinRegion::eye, kEye);
  const Carriers carriers(h.skin, h.skull, {});
  const SurfaceMesh& all = carriers.query().mesh();
  double volume = 0;
  for (std::size_t t = h.skull.mesh.triangles.size(); t < all.triangles.size(); ++t) {
    const auto& [a, b, c] = all.triangles[t];
    volume += all.points[a].dot(all.points[b].cross(all.points[c])) / 6;
  }
  const double ball = 4.0 / 3 * M_PI * std::pow(OrganOptions{}.globe_radius, 3);
  EXPECT_NEAR(volume, ball, 0.02 * ball);  // 36 x 18 faces
}

TEST(Carriers, CartilageLiesUnderTheNosesCoverUnlessBoneIsNearer) {
  scenes::Head h = head_with(SkinRegion::nose, kTip);
  OrganOptions o;
  const auto depth = [&] {
    const Carriers carriers(h.skin, h.skull, o);
    return carriers.query().cast(kTip, -Vec3::UnitZ(), 60)->distance;
  };
  EXPECT_NEAR(depth(), o.nose_cover, 0.3);  // the skin leans 12 degrees there
  o.nose_cover = 30;                        // bone is nearer: no cartilage
  const double bone = depth();
  o.organs = Organs::held;
  EXPECT_EQ(depth(), bone);
  EXPECT_LT(bone, 30);
}

TEST(Carriers, NoRayFromTheNoseSlipsPastTheCartilagesBorder) {
  const scenes::Head h = head_with(SkinRegion::nose, kTip);
  const OrganOptions o;
  const Carriers carriers(h.skin, h.skull, o);
  const std::vector<Vec3> normal = smoothed_normals(h.skin.skin, 8);
  for (std::size_t p = 0; p < normal.size(); ++p)
    if (h.skin.region[p] == SkinRegion::nose) {
      const auto hit = carriers.query().cast(h.skin.skin.points[p], -normal[p], 60);
      EXPECT_LT(hit->distance, 1.1 * o.nose_cover) << h.skin.skin.points[p].transpose();
    }
}

TEST(Carriers, SharesTellOrganFromBone) {
  const scenes::Head h = head_with(SkinRegion::nose, kTip);
  const Carriers carriers(h.skin, h.skull, {});
  EXPECT_EQ(carriers.organ_share(kTip, Vec3::UnitZ(), 8), 1);
  EXPECT_EQ(carriers.organ_share({0, 100, 0}, Vec3::UnitY(), 8), 0);
  const Vec3 border = kTip + Vec3(kPatch, 0, -2);
  const double share = carriers.organ_share(border, Vec3::UnitZ(), 8);
  EXPECT_GT(share, 0);
  EXPECT_LT(share, 1);
}

TEST(Carriers, AnOrgansCurveIsItsCoverPlusWhatItGives) {
  const scenes::Head h = head_with(SkinRegion::nose, kTip);
  const std::size_t tip = nearest(h, kTip), crown = nearest(h, {0, 100, 0});
  const SkinPoints points{{h.skin.skin.points[tip], h.skin.skin.points[crown]},
                          {SkinRegion::nose, SkinRegion::cranium}};
  SweepOptions o;
  o.mode = SweepMode::exact;
  o.loads = 3;
  const auto map = [&](double give) {
    o.organs.give = give;
    return sweep(h.skin, h.skull, points, o).map;
  };
  const StiffnessMap firm = map(0), soft = map(0.7);
  ASSERT_TRUE(firm.has_curve(0));
  EXPECT_EQ(firm.status[0], VertexStatus::solved);
  EXPECT_NEAR(firm.depth[0], o.organs.nose_cover, 0.5);
  for (std::size_t l = 0; l < firm.forces.size(); ++l) {
    EXPECT_NEAR(soft.curve(0)[l], firm.curve(0)[l] + 0.7 * firm.forces[l], 1e-12);
    EXPECT_EQ(soft.curve(1)[l], firm.curve(1)[l]);
  }
  EXPECT_GE(soft.error[0], o.organs.give_error);
  EXPECT_LT(soft.error[1], 0.1);
}

}  // namespace
}  // namespace palpate::stiffness
