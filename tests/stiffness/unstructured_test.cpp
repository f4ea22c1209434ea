// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/unstructured.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.hpp"
#include "stiffness/press_sites.hpp"

namespace palpate::stiffness {
namespace {

/// A slab of flesh, 60 x 60 x 8 mm, skin on top (its nodes first), bone below.
TissueMesh slab(int across, int deep) {
  const double side = 60, depth = 8;
  TissueMesh m;
  const int n = across + 1;
  for (int k = 0; k <= deep; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        m.nodes.push_back(
            {side * i / across - side / 2, side * j / across - side / 2, -depth * k / deep});
  m.skin_points = static_cast<std::size_t>(n) * n;
  const auto at = [n](int i, int j, int k) { return (k * n + j) * n + i; };
  for (int k = 0; k < deep; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        // Six tetrahedra about the diagonal from one corner to the opposite one.
        const int corner[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        int order[3] = {0, 1, 2};
        do {
          int p[3] = {i, j, k};
          Tetrahedron t;
          t[0] = at(p[0], p[1], p[2]);
          for (int s = 0; s < 3; ++s) {
            for (int a = 0; a < 3; ++a) p[a] += corner[order[s]][a];
            t[s + 1] = at(p[0], p[1], p[2]);
          }
          const Vec3& o = m.nodes[t[0]];
          if ((m.nodes[t[1]] - o).cross(m.nodes[t[2]] - o).dot(m.nodes[t[3]] - o) < 0)
            std::swap(t[2], t[3]);
          m.tets.push_back(t);
        } while (std::next_permutation(order, order + 3));
      }
  m.label.assign(m.tets.size(), TissueLabel::flesh);
  for (const Vec3& p : m.nodes) m.held.push_back(p.z() < -depth + 1e-9);
  return m;
}

TEST(Unstructured, RefinementFillsTheSamePieceAndInvertsNothing) {
  const TissueMesh tissue = slab(10, 2);
  const SiteFrame frame = site_frame({3, -2, 0}, Vec3::UnitZ());
  const LocalBody body = TissueCutter(tissue).cut(frame, 8);
  double volume = 0;
  for (int t = 0; t < body.mesh.size(); ++t) {
    EXPECT_GT(fem::corner_volume(body.mesh, t), 0);
    volume += fem::corner_volume(body.mesh, t);
  }
  double taken = 0;
  for (const Tetrahedron& t : tissue.tets) {
    Vec3 center = Vec3::Zero();
    for (const auto n : t) center += 0.25 * (tissue.nodes[n] - frame.origin);
    if (center.norm() <= 32) taken += 6 * 6 * 4 / 6.0;
  }
  EXPECT_NEAR(volume, taken, 1e-6 * taken);
  EXPECT_EQ(body.held.size(), body.mesh.nodes.size());
  EXPECT_FALSE(body.touchable.empty());
}

TEST(Unstructured, AgreesWithThePatchOnASlab) {
  const auto law = std::shared_ptr(fem::neo_hookean(fem::lame_moduli(0.045658, 0.43)));
  const std::vector<double> forces = {1, 2};
  const TissueMesh tissue = slab(10, 2);
  const LocalBody body = TissueCutter(tissue).cut(site_frame({3, -2, 0}, Vec3::UnitZ()), 8);
  const SiteCurve piece = press_unstructured(body, law, {}, forces, std::vector<double>{0, 8, 16});
  ASSERT_EQ(piece.travel.size(), 2u);
  EXPECT_EQ(piece.method, SolveMethod::unstructured);
  EXPECT_EQ(piece.sunk.size(), 6u);
  EXPECT_GT(piece.sunk[0], piece.sunk[2]);

  const PatchTemplate t = make_template(rule_for_depth(8, 8));
  PatchGeometry g;
  g.height.assign(t.columns.size(), 0.0);
  g.thickness.assign(t.columns.size(), 8.0);
  fem::Cholesky cholesky(t.topology.pattern);
  const SiteCurve patch =
      press_site(t, patch_nodes(t, g, t.rule.first_layer), law, {}, forces, cholesky);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(piece.travel[i] / patch.travel[i], 1, 0.04);
}

TEST(Unstructured, SkinThatTheMeshHoldsDoesNotCarryTheTool) {
  const auto law = std::shared_ptr(fem::neo_hookean(fem::lame_moduli(0.045658, 0.43)));
  const std::vector<double> forces = {1}, rings = {0, 8, 16};
  const SiteFrame frame = site_frame({3, -2, 0}, Vec3::UnitZ());
  TissueMesh tissue = slab(10, 2);
  const auto travel = [&] {
    return press_unstructured(TissueCutter(tissue).cut(frame, 8), law, {}, forces, rings).travel;
  };
  const std::vector<double> free = travel();
  for (std::size_t n = 0; n < tissue.skin_points; ++n)
    tissue.held[n] = tissue.nodes[n].x() > 0;  // as beside an ear
  EXPECT_EQ(travel(), free);
}

TEST(Unstructured, APieceWithoutBoneHangsOnItsCut) {
  const auto law = std::shared_ptr(fem::neo_hookean(fem::lame_moduli(0.045658, 0.43)));
  TissueMesh tissue = slab(14, 6);
  for (Vec3& p : tissue.nodes) p *= 5;  // 40 mm deep; the piece reaches 32
  std::fill(tissue.held.begin(), tissue.held.end(), 0);
  const LocalBody body = TissueCutter(tissue).cut(site_frame({3, -2, 0}, Vec3::UnitZ()), 8);
  ASSERT_GT(std::count(body.held.begin(), body.held.end(), 1), 0);
  for (std::size_t n = 0; n < body.held.size(); ++n)
    if (body.held[n]) EXPECT_GT(body.mesh.nodes[n].norm(), 10);
  const SiteCurve curve =
      press_unstructured(body, law, {}, std::vector<double>{1}, std::vector<double>{0, 8, 16});
  ASSERT_EQ(curve.travel.size(), 1u);
  EXPECT_GT(curve.travel[0], 1);
  EXPECT_LT(curve.travel[0], 6);
}

}  // namespace
}  // namespace palpate::stiffness
