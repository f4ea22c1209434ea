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
    solved.information = information * Eigen::MatrixXd::Identity(3 * n, 3 * n);
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

TEST(Spread, AddsTheMapsDoubt) {
  // Independent control points of SD 4 mm: the shares' squares sum to 0.2 and more, less than 1.
  const Scene scene(1 / 16.0);
  const SkullSpread spread =
      draw_spread(scene.skull, scene.skull.mesh.points, scene.solved, scene.model, scene.skin);
  for (std::size_t v = 0; v < spread.deviation.size(); v += 50) {
    EXPECT_GT(spread.deviation[v], scene.model.sd[v]);
    EXPECT_LT(spread.deviation[v], std::hypot(scene.model.sd[v], 4.0));
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
