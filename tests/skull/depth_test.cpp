// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "registration/place.hpp"
#include "shapes.hpp"
#include "skull/depth_fit.hpp"
#include "skull/depth_terms.hpp"

namespace palpate::skull {
namespace {

const Vec3 kAxes(70, 85, 95);

std::vector<Vec3> pushed(const std::vector<Vec3>& x, const std::vector<Vec3>& step, double by) {
  std::vector<Vec3> y = x;
  for (std::size_t i = 0; i < x.size(); ++i) y[i] += by * step[i];
  return y;
}

TEST(DepthTerms, GradientIsTheDifferenceQuotientOfTheEnergy) {
  const SkullTemplate skull = egg_template(kAxes);
  HeadSurface head = head_of(ellipsoid(kAxes, 6, 4));
  head.landmarks["nose_tip"] = {{0, -18, 110}, 1};
  head.landmarks["ear_left"] = {{80, 3, -2}, 1};
  const SkinField skin(head);
  FitOptions options;
  options.depth.sampling = 12;
  const DepthModel model = make_depth_model(skull, even_table(6));
  const std::vector<FitPoint> points = make_fit_points(head, skull, model, options);
  // Some points deep, some within the clearance, some outside.
  std::vector<Vec3> x, step, normals;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 out = points[i].rest.normalized();
    // Off the mirror plane, where two triangles are equally near and the distance has a kink.
    const Vec3 aside(0.1 + 0.05 * std::sin(2.9 * i), 0.07, 0.03 * std::cos(1.1 * i));
    x.push_back(points[i].rest + (8.0 * std::sin(1.7 * i)) * out + aside);
    step.emplace_back(std::sin(0.9 * i), std::cos(1.3 * i), std::sin(2.1 * i + 1));
    normals.push_back(points[i].normal);
  }
  const Standing now = standing(points, x, normals, skin, options);
  const Linearisation lin = linearise(points, x, now, skin, options);
  double slope = 0;
  for (const Row& row : lin.rows)
    slope -= row.weight * row.residual * row.direction.dot(step[row.point]);
  constexpr double kStep = 1e-5;
  const double up = linearise(points, pushed(x, step, kStep), now, skin, options).energy;
  const double down = linearise(points, pushed(x, step, -kStep), now, skin, options).energy;
  EXPECT_NEAR((up - down) / (2 * kStep), slope, 1e-4 * std::abs(slope));
}

TEST(DepthTerms, EarsNeckAndFilledSkinDoNotAttract) {
  const SkullTemplate skull = egg_template(kAxes);
  HeadSurface head = head_of(ellipsoid(kAxes, 6, 4));
  for (std::size_t i = 0; i < head.skin.points.size(); ++i) {
    if (head.skin.points[i].x() > 50) head.region[i] = SkinRegion::ear;
    if (head.skin.points[i].y() < -50) head.region[i] = SkinRegion::neck;
    head.filled[i] = head.skin.points[i].z() > 85;
  }
  const SkinField skin(head);
  const FitOptions options;
  const std::vector<FitPoint> points =
      make_fit_points(head, skull, make_depth_model(skull, even_table(6)), options);
  std::vector<Vec3> x, normals;
  for (const FitPoint& p : points) {
    x.push_back(p.rest);
    normals.push_back(p.normal);
  }
  const Standing now = standing(points, x, normals, skin, options);
  int drawn = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!now.drawn[i]) continue;
    ++drawn;
    EXPECT_FALSE(x[i].x() > 55 || x[i].y() < -55 || x[i].z() > 88);
  }
  EXPECT_GT(drawn, 100);
}

TEST(DepthModel, MeetsTheTableAtItsLandmarksAndDoubtsGrowAway) {
  SkullTemplate skull = egg_template(kAxes);
  std::fill(skull.region.begin(), skull.region.end(), SkullRegion::cheekbone);
  std::vector<TissueDepth> table = even_table(6);
  table[3].mean_mm = 12;  // n
  const DepthModel model = make_depth_model(skull, table);
  ASSERT_EQ(model.landmarks.size(), 6u);
  std::size_t at_n = 0, far = 0;
  for (std::size_t i = 0; i < skull.mesh.points.size(); ++i) {
    const Vec3& p = skull.mesh.points[i];
    if (p.z() > skull.mesh.points[at_n].z()) at_n = i;
    if (p.y() < skull.mesh.points[far].y()) far = i;
  }
  EXPECT_NEAR(model.mean[at_n], 12, 0.5);
  EXPECT_LT(model.sd[at_n], 2.4);
  EXPECT_GT(model.sd[far], 4.5);
}

TEST(DepthModel, TypicalVariationIsTheTablesMedian) {
  std::vector<TissueDepth> table = even_table(10);
  for (std::size_t i = 0; i < table.size(); ++i) table[i].sd_mm = i < 2 ? 0 : 1.0 + i;
  std::vector<double> shares;
  for (const TissueDepth& row : table)
    if (row.sd_mm > 0) shares.push_back(row.sd_mm / row.mean_mm);
  EXPECT_DOUBLE_EQ(typical_variation(table), shares[shares.size() / 2]);
  for (TissueDepth& row : table) row.sd_mm = 0;
  EXPECT_GT(typical_variation(table), 0);
}

TEST(DepthModel, TheLevelOfTheVaultComesFromTheTable) {
  // Every landmark of a smooth vault says the same: so does every place between and beyond them.
  SkullTemplate skull = egg_template(kAxes);
  std::fill(skull.region.begin(), skull.region.end(), SkullRegion::cranium);
  for (const double depth : {4.0, 9.0}) {
    const DepthModel model = make_depth_model(skull, even_table(depth));
    for (std::size_t i = 0; i < model.mean.size(); i += 20)
      EXPECT_NEAR(model.mean[i], depth, 0.3) << i;
  }
}

TEST(DepthModel, PeopleDifferMoreWhereFleshIsThick) {
  SkullTemplate skull = egg_template(kAxes);
  std::fill(skull.region.begin(), skull.region.end(), SkullRegion::cranium);
  std::vector<TissueDepth> thin = even_table(4), thick = even_table(8);
  for (auto* table : {&thin, &thick})
    for (TissueDepth& row : *table) row.sd_mm = 0.25 * row.mean_mm;
  const DepthModel a = make_depth_model(skull, thin), b = make_depth_model(skull, thick);
  for (std::size_t i = 0; i < a.sd.size(); i += 20) {
    EXPECT_LT(a.sd[i], b.sd[i]);
    EXPECT_GE(a.sd[i], 0.25 * (a.mean[i] - 1.5));  // the scalp's own, less a little hollow
    EXPECT_LT(a.sd[i], 2.2);
  }
}

TEST(DepthModel, HollowsOfTheHullAreDeeper) {
  SurfaceMesh mesh = ellipsoid({80, 80, 80}, 0, 4);
  std::size_t dented = 0;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (mesh.points[i].x() > mesh.points[dented].x()) dented = i;
  mesh.points[dented] *= 0.9;
  const std::vector<double> gaps = hull_gaps(mesh);
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    EXPECT_GE(gaps[i], 0);
    if (i == dented) {
      EXPECT_NEAR(gaps[i], 8, 0.6);
    } else {
      EXPECT_LT(gaps[i], 0.5);
    }
  }
}

TEST(DepthModel, RefusesATemplateWithoutTheTablesLandmarks) {
  SkullTemplate skull = egg_template(kAxes);
  skull.landmarks.clear();
  EXPECT_THROW(make_depth_model(skull, even_table(6)), InputError);
}

}  // namespace
}  // namespace palpate::skull
