// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/tissue_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenes.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/site.hpp"

namespace palpate::stiffness {
namespace {

PatchGeometry slab(const PatchTemplate& t, double thickness) {
  PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), thickness);
  g.spot.assign(t.columns.size(), {});
  return g;
}

TissueModel layered(double top, double bottom, TissueLaw law = TissueLaw::neo_hookean) {
  TissueModel m;
  m.kind = TissueKind::layered;
  m.layers = {{"top", 0.3, top, 0.43, law}, {"bottom", 0.7, bottom, 0.43, law}};
  return m;
}

/// Travel at 1 and 3 N on a slab of 8 mm, in double precision.
std::vector<double> press_slab(const TissueModel& model) {
  const Flesh flesh(model, scenes::head(2).skin);
  PatchRule rule;
  rule.rings = {{3, 6}, {7, 8}, {16, 6}, {40, 6}};
  rule.layers = flesh.element_layers(2);
  rule.touch_radius = 13;
  rule.hold_rim = false;
  const PatchTemplate t = make_template(rule);
  const PatchGeometry g = slab(t, 8);
  fem::Cholesky cholesky(t.topology.pattern);
  const std::vector<double> forces = {1, 3};
  return press_site(t, patch_nodes(t, g, 2.5, flesh.levels(rule.layers)), flesh.laws(t, g), {},
                    forces, cholesky)
      .travel;
}

TEST(TissueModel, EqualLayersAreOneMaterial) {
  const auto uniform = press_slab({});
  const auto layers = press_slab(layered(0.045658, 0.045658));
  ASSERT_EQ(layers.size(), 2u);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(layers[i] / uniform[i], 1, 0.02);  // other levels
}

TEST(TissueModel, AStiffSkinOverASoftBaseLiesBetween) {
  const auto soft = press_slab(layered(0.02, 0.02)), mixed = press_slab(layered(0.08, 0.02)),
             stiff = press_slab(layered(0.08, 0.08));
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(mixed[i], 0.98 * soft[i]);
    EXPECT_GT(mixed[i], 1.1 * stiff[i]);
  }
}

TEST(TissueModel, LayersMayHaveTheirOwnLaw) {
  const TissueModel m = layered(0.03, 0.03, TissueLaw::mooney_rivlin);
  EXPECT_FALSE(Flesh(m, scenes::head(2).skin).neo_hookean_only());
  const auto mooney = press_slab(m), neo = press_slab(layered(0.03, 0.03));
  ASSERT_EQ(mooney.size(), 2u);
  EXPECT_NEAR(mooney[0] / neo[0], 1, 0.25);  // the same small-strain moduli
  EXPECT_NE(mooney[1], neo[1]);
}

TEST(TissueModel, ARegionalFieldIsSmoothAndReachesItsFigures) {
  scenes::Head head = scenes::head(3);
  for (std::size_t p = 0; p < head.skin.region.size(); ++p)
    if (head.skin.skin.points[p].x() > 0) head.skin.region[p] = SkinRegion::chin;
  TissueModel m;
  m.kind = TissueKind::regional;
  m.by_region[static_cast<std::size_t>(SkinRegion::cheek)] = 0.02;
  m.by_region[static_cast<std::size_t>(SkinRegion::chin)] = 0.08;
  const Flesh flesh(m, head.skin);
  const auto& mesh = head.skin.skin;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    PatchGeometry g;
    g.spot = {{static_cast<std::int32_t>(t), Vec3(1, 1, 1) / 3}};
    const double e = flesh.surface_modulus(g);
    const double x = (mesh.points[mesh.triangles[t][0]] + mesh.points[mesh.triangles[t][1]] +
                      mesh.points[mesh.triangles[t][2]])
                         .x() /
                     3;
    if (x > 30) EXPECT_NEAR(e, 0.08, 1e-9);
    if (x < -30) EXPECT_NEAR(e, 0.02, 1e-9);
    EXPECT_GT(e, 0.0199);
    EXPECT_LT(e, 0.0801);
  }
}

TEST(TissueModel, LevelsEndWhereLayersDo) {
  const Flesh flesh(layered(1, 2), scenes::head(2).skin);
  EXPECT_EQ(flesh.levels(2), (std::vector<double>{0, 0.3, 1}));
  EXPECT_EQ(flesh.levels(3), (std::vector<double>{0, 0.3, 0.65, 1}));
  EXPECT_TRUE(Flesh({}, scenes::head(2).skin).levels(3).empty());
}

TEST(TissueModel, NamesTheKeyThatCannotBe) {
  const auto message = [](TissueModel m) -> std::string {
    try {
      check(m);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  TissueModel m;
  EXPECT_EQ(message(m), "");
  m.youngs_modulus = 0;
  EXPECT_NE(message(m).find("youngs_modulus_kpa"), std::string::npos);
  m = {};
  m.poissons_ratio = 0.5;
  EXPECT_NE(message(m).find("poissons_ratio"), std::string::npos);
  m = layered(1, 2);
  m.layers[1].share = 0.6;
  EXPECT_NE(message(m).find("share_of_depth"), std::string::npos);
  m.layers[1].youngs_modulus = -1;
  EXPECT_NE(message(m).find("'bottom'"), std::string::npos);
}

}  // namespace
}  // namespace palpate::stiffness
