// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/fit.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "shapes.hpp"
#include "surface/query.hpp"

namespace palpate::skull {
namespace {

const Vec3 kAxes(70, 85, 95);
constexpr double kDepth = 5.5;  // what the model expects on an even vault

/// A head whose bone is the egg under `map`, skin everywhere kDepth above it.
struct KnownHead {
  SurfaceMesh bone;
  HeadSurface head;
};
KnownHead known_head(const SkullTemplate& skull, const Mat3& turn, const Vec3& axes,
                     const Vec3& shift, double landmark_error) {
  KnownHead known;
  known.bone = transformed(ellipsoid(axes, 0, 5), turn, shift);
  known.head = head_of(transformed(ellipsoid(axes, kDepth, 5), turn, shift));
  double sign = 1;
  for (const auto& [name, p] : skull.registration_points) {
    const Vec3 there = turn * p.cwiseProduct(axes.cwiseQuotient(kAxes)) + shift;
    known.head.landmarks[name] = {there + landmark_error * sign * Vec3(0.6, 0.6, 0.5), 1};
    sign = -sign;
  }
  return known;
}

TEST(DepthFit, RecoversABoneOfKnownDepthInAnotherSizeShapeAndPose) {
  const SkullTemplate skull = egg_template(kAxes);
  const Mat3 turn = Eigen::AngleAxisd(0.12, Vec3(1, 0.5, 0.2).normalized()).toRotationMatrix();
  const KnownHead known =
      known_head(skull, turn, Vec3(1.12, 1.03, 1.08).cwiseProduct(kAxes), {3, -40, 12}, 5);
  FitOptions options;  // here depths are facts, place by place, and the face's points are 5 mm off
  options.depth.patch_area = 400;
  const SkullFit fit = fit_skull(known.head, skull, even_table(kDepth), options);
  const surface::SurfaceQuery truth(known.bone);
  for (const Vec3& p : fit.mesh.points) EXPECT_LT(truth.closest(p).distance, 0.8);
  EXPECT_EQ(fit.statistics.at("outside_count"), 0);
  EXPECT_EQ(fit.statistics.at("self_intersections"), 0);
  EXPECT_GE(fit.statistics.at("min_clearance_mm"), 2.5);
  ASSERT_EQ(fit.depths.size(), 6u);
  for (const DepthRow& row : fit.depths) {
    EXPECT_TRUE(row.reached);
    EXPECT_NEAR(row.depth_mm, kDepth, 0.6);
  }
}

TEST(DepthFit, MirroredHeadGivesMirroredSkull) {
  const SkullTemplate skull = egg_template(kAxes);
  const Mat3 turn = Eigen::AngleAxisd(0.1, Vec3(0, 1, 0.4).normalized()).toRotationMatrix();
  const KnownHead known =
      known_head(skull, turn, Vec3(1.05, 1.0, 1.1).cwiseProduct(kAxes), {2, 1, 0}, 3);
  HeadSurface mirrored = known.head;
  mirrored.landmarks.clear();
  for (Vec3& p : mirrored.skin.points) p.x() = -p.x();
  for (Triangle& t : mirrored.skin.triangles) std::swap(t[0], t[1]);
  for (const auto& [name, landmark] : known.head.landmarks) {
    std::string other = name;
    if (const auto at = name.find("_left"); at != name.npos) other.replace(at, 5, "_right");
    if (const auto at = name.find("_right"); at != name.npos) other.replace(at, 6, "_left");
    mirrored.landmarks[other] = landmark;
    mirrored.landmarks[other].position.x() *= -1;
  }
  const SkullFit a = fit_skull(known.head, skull, even_table(kDepth));
  const SkullFit b = fit_skull(mirrored, skull, even_table(kDepth));
  const surface::SurfaceQuery query(b.mesh);
  for (const Vec3& p : a.mesh.points)
    EXPECT_LT(query.closest(Vec3(-p.x(), p.y(), p.z())).distance, 0.1);
  EXPECT_NEAR(a.landmarks.at("zy_left").position.x(), -b.landmarks.at("zy_right").position.x(),
              0.1);
}

// Half a head was scanned; what completes it says gently where the other half's bone lies.
TEST(DepthFit, CompletedSkinHoldsTheBoneThatNobodyScanned) {
  const SkullTemplate skull = egg_template(kAxes);
  KnownHead known =
      known_head(skull, Mat3::Identity(), Vec3(1.0, 1.0, 1.15).cwiseProduct(kAxes), {0, 0, 0}, 0);
  for (std::size_t v = 0; v < known.head.filled.size(); ++v)
    if (known.head.skin.points[v].z() < 10) known.head.filled[v] = 2;
  const surface::SurfaceQuery truth(known.bone);
  const auto worst_behind = [&](double completed_sd) {
    FitOptions options;
    options.depth.completed_sd = completed_sd;
    const SkullFit fit = fit_skull(known.head, skull, even_table(kDepth), options);
    double worst = 0;
    for (const Vec3& p : fit.mesh.points)
      if (p.z() < -40) worst = std::max(worst, truth.closest(p).distance);
    return worst;
  };
  const double with = worst_behind(DepthFitOptions{}.completed_sd), without = worst_behind(1e6);
  EXPECT_LT(with, 3);
  EXPECT_LT(with, 0.6 * without);
}

TEST(DepthFit, SameBitsTwice) {
  const SkullTemplate skull = egg_template(kAxes);
  const KnownHead known = known_head(skull, Mat3::Identity(), 1.05 * kAxes, {0, 0, 0}, 2);
  const SkullFit a = fit_skull(known.head, skull, even_table(kDepth));
  const SkullFit b = fit_skull(known.head, skull, even_table(kDepth));
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.statistics, b.statistics);
}

TEST(DepthFit, BoneBeyondTheEndOfTheScanIsCutOff) {
  const SkullTemplate skull = egg_template(kAxes);
  KnownHead known = known_head(skull, Mat3::Identity(), kAxes, {0, 0, 0}, 0);
  for (Vec3& p : known.head.skin.points) p.y() = std::max(p.y(), -45.0);  // cut at the mouth
  SkullTemplate marked = skull;
  marked.landmarks["gn"] = {{0, -85, 0}, {0, -1, 0}};
  std::vector<TissueDepth> table = even_table(kDepth);
  table.push_back({"gn", "gnathion", kDepth, 2, "test"});
  const SkullFit fit = fit_skull(known.head, marked, table);
  EXPECT_GT(fit.statistics.at("clipped_mm3"), 1e5);
  EXPECT_EQ(fit.statistics.at("below_clearance_count"), 0);
  for (const Vec3& p : fit.mesh.points) EXPECT_GE(p.y(), -42.5);
  EXPECT_EQ(fit.region.size(), fit.mesh.points.size());
  EXPECT_EQ(fit.warnings.size(), 1u);
  bool named = false;
  for (const DepthRow& row : fit.depths)
    if (row.code == "gn") {
      named = true;
      EXPECT_FALSE(row.reached);
      EXPECT_TRUE(std::isnan(row.depth_mm));
    }
  EXPECT_TRUE(named);
}

TEST(DepthFit, NeedsThreeSharedPoints) {
  const SkullTemplate skull = egg_template(kAxes);
  KnownHead known = known_head(skull, Mat3::Identity(), kAxes, {0, 0, 0}, 0);
  known.head.landmarks.clear();
  EXPECT_THROW(fit_skull(known.head, skull, even_table(kDepth)), InputError);
}

TEST(PublishedFit, DrawsBoneToTheSkinAndSaysSo) {
  SkullTemplate skull = egg_template(kAxes);
  for (std::size_t i = 0; i < skull.mesh.points.size(); ++i) {
    const Vec3& p = skull.mesh.points[i];
    skull.region[i] = p.y() > 40    ? SkullRegion::cranium
                      : p.z() < 30  ? SkullRegion::none
                      : p.y() > 25  ? SkullRegion::forehead
                      : p.y() > 15  ? SkullRegion::eyebrow
                      : p.y() > 0   ? SkullRegion::orbit
                      : p.y() > -30 ? SkullRegion::cheekbone
                      : p.y() > -60 ? SkullRegion::jaw
                                    : SkullRegion::chin;
  }
  const KnownHead known = known_head(skull, Mat3::Identity(), 1.05 * kAxes, {0, 0, 0}, 0);
  FitOptions options;
  options.method = Method::published;
  const SkullFit fit = fit_skull(known.head, skull, even_table(kDepth), options);
  EXPECT_EQ(fit.mesh.points.size(), skull.mesh.points.size());
  double mean = 0;
  for (const DepthRow& row : fit.depths) mean += row.depth_mm / fit.depths.size();
  EXPECT_LT(mean, 0.6 * kDepth);  // nothing holds it at the published depth
  EXPECT_FALSE(fit.warnings.empty());
  skull.region.assign(skull.region.size(), SkullRegion::cranium);
  EXPECT_THROW(fit_skull(known.head, skull, even_table(kDepth), options), InputError);
}

}  // namespace
}  // namespace palpate::skull
