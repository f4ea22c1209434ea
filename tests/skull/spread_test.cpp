// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/spread.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace palpate::skull {
namespace {

const Vec3 kAxes(70, 85, 95);

/// An egg that already lies where it belongs, and a posterior of the map that is known.
struct Scene {
  SkullTemplate skull = egg_template(kAxes);
  HeadSurface head = head_of(ellipsoid(kAxes, 6, 5));
  SkinField skin{head};
  DepthModel model = make_depth_model(skull, even_table(6));
  DepthFit solved{
      {Mat3::Identity(), Vec3::Zero(), SplineLattice(bounding_box(skull.mesh.points), 60), {}}};

  explicit Scene(double information) {
    const int n = solved.map.lattice.size();
    solved.map.control = Eigen::MatrixX3d::Zero(n, 3);
    solved.information = information * Eigen::MatrixXd::Identity(3 * n + 3, 3 * n + 3);
  }
};

TEST(Spread, OfACertainMapIsTheIndividualsAlone) {
  const Scene scene(1e12);
  const SkullSpread spread =
      draw_spread(scene.skull, scene.skull.mesh.points, scene.solved, scene.model, scene.skin);
  ASSERT_EQ(spread.deviation.size(), scene.skull.mesh.points.size());
  for (std::size_t v = 0; v < spread.deviation.size(); ++v)
    EXPECT_NEAR(spread.deviation[v], scene.model.sd[v], 1e-3);
}

TEST(Spread, IsTheTablesWholeSpreadAndTheMapsDoubtWhereThatIsLarger) {
  // Independent control points of one SD: the variance along the way is that of the shares'
  // squares.
  for (const double sd : {1.0, 4.0, 12.0}) {
    const Scene scene(1 / (sd * sd));
    const SkullSpread spread =
        draw_spread(scene.skull, scene.skull.mesh.points, scene.solved, scene.model, scene.skin);
    int by_map = 0;
    for (std::size_t v = 0; v < spread.deviation.size(); v += 50) {
      double squares = 0;
      for (const double share : scene.solved.map.lattice.weights(scene.skull.mesh.points[v]).share)
        squares += share * share;
      const double of_map = sd * std::sqrt(squares);
      by_map += of_map > scene.model.sd[v];
      EXPECT_NEAR(spread.deviation[v], std::max(of_map, scene.model.sd[v]), 1e-3);
    }
    EXPECT_EQ(by_map > 0, sd > 10) << sd;
  }
}

TEST(Spread, CompletedSkinAddsItsOwnDoubt) {
  Scene scene(1e12);
  for (std::size_t v = 0; v < scene.head.filled.size(); ++v)
    if (scene.head.skin.points[v].z() < 0) scene.head.filled[v] = 2;
  const SkinField skin(scene.head);
  const SpreadOptions options;
  const SkullSpread spread =
      draw_spread(scene.skull, scene.skull.mesh.points, scene.solved, scene.model, skin, options);
  for (std::size_t v = 0; v < spread.deviation.size(); ++v) {
    const double z = scene.skull.mesh.points[v].z(), people = scene.model.sd[v];
    if (std::abs(z) < 6) continue;  // the border's triangles
    EXPECT_NEAR(spread.deviation[v], z > 0 ? people : std::hypot(people, options.completed_sd),
                1e-3);
  }
}

TEST(Spread, DrawsOfAnUncertainMapHaveTheSameSpread) {
  // The map gives the draws a part of the table's spread, the individual's field the rest.
  const Scene scene(1 / 16.0);
  SpreadOptions options;
  options.draws = 400;
  const SkullSpread spread = draw_spread(scene.skull, scene.skull.mesh.points, scene.solved,
                                         scene.model, scene.skin, options);
  for (std::size_t v = 0; v < scene.skull.mesh.points.size(); v += 500) {
    const Vec3 inward = scene.skin.at(scene.skull.mesh.points[v]).gradient;
    double sum = 0;
    for (const auto& draw : spread.offset)
      sum += std::pow(std::max(0.0, inward.dot(draw[v])), 2);  // inward nothing is cut off
    EXPECT_NEAR(std::sqrt(2 * sum / 400), spread.deviation[v], 0.25 * spread.deviation[v]);
  }
}

TEST(Spread, DrawsHaveTheStatedSpreadAndStayUnderTheSkin) {
  const Scene scene(1e12);
  SpreadOptions options;
  options.draws = 400;
  const SkullSpread spread = draw_spread(scene.skull, scene.skull.mesh.points, scene.solved,
                                         scene.model, scene.skin, options);
  ASSERT_EQ(spread.offset.size(), 400u);
  for (std::size_t v = 0; v < scene.skull.mesh.points.size(); v += 500) {
    const Vec3& p = scene.skull.mesh.points[v];
    const SkinDepth here = scene.skin.at(p);
    double sum = 0;
    for (const auto& draw : spread.offset) {
      const double inward = here.gradient.dot(draw[v]);
      EXPECT_GE(here.depth + inward, options.least_depth - 1e-9);
      sum += std::pow(std::max(0.0, inward), 2);  // inward nothing is cut off
    }
    EXPECT_NEAR(std::sqrt(2 * sum / 400), scene.model.sd[v], 0.25 * scene.model.sd[v]);
  }
}

TEST(Spread, SameBitsTwiceAndAnotherSeedAnotherDraw) {
  const Scene scene(1);
  const auto draw = [&](std::uint64_t seed) {
    SpreadOptions options;
    options.draws = 2;
    options.seed = seed;
    return draw_spread(scene.skull, scene.skull.mesh.points, scene.solved, scene.model, scene.skin,
                       options)
        .offset;
  };
  EXPECT_EQ(draw(1), draw(1));
  EXPECT_NE(draw(1)[0], draw(2)[0]);
}

}  // namespace
}  // namespace palpate::skull
