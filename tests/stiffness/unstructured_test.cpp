// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/unstructured.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.hpp"
#include "stiffness/piece_mesh.hpp"
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

fem::TetMesh linear_mesh(const TissuePiece& piece) {
  fem::TetMesh m;
  m.nodes = piece.nodes;
  for (const Tetrahedron& t : piece.tets) m.tets.insert(m.tets.end(), t.begin(), t.end());
  return m;
}

TissuePiece whole(const TissueMesh& m) {
  TissuePiece p;
  p.nodes = m.nodes;
  p.held = m.held;
  p.tets = m.tets;
  for (std::size_t n = 0; n < m.nodes.size(); ++n) p.skin.push_back(n < m.skin_points);
  return p;
}

double volume_of(const fem::TetMesh& m) {
  double sum = 0;
  for (int t = 0; t < m.size(); ++t) sum += fem::corner_volume(m, t);
  return sum;
}

/// [mm^2] of the boundary faces whose three nodes carry the flag.
double area_of(const TissuePiece& piece, const std::vector<std::uint8_t>& flag) {
  const fem::FaceList faces = fem::boundary_faces(linear_mesh(piece));
  double sum = 0;
  for (std::size_t f = 0; f < faces.size(); f += 3) {
    const Vec3 &a = piece.nodes[faces[f]], &b = piece.nodes[faces[f + 1]],
               &c = piece.nodes[faces[f + 2]];
    if (flag[faces[f]] && flag[faces[f + 1]] && flag[faces[f + 2]])
      sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

TEST(PieceMesh, BisectionFillsTheSameSolidAndInvertsNothing) {
  const TissuePiece coarse = whole(slab(10, 2));
  PieceMesh mesh(coarse);
  const auto size = [](const Vec3& at) { return 1.5 + 0.3 * at.norm(); };
  mesh.refine(size, 100000);
  const TissuePiece piece = mesh.piece();
  const fem::TetMesh solid = linear_mesh(piece);
  EXPECT_GT(piece.tets.size(), 2 * coarse.tets.size());
  EXPECT_NO_THROW(fem::check_mesh(solid));
  EXPECT_NEAR(volume_of(solid), 60 * 60 * 8, 1e-6);
  EXPECT_NEAR(area_of(piece, piece.skin), 3600, 1e-6);
  EXPECT_NEAR(area_of(piece, piece.held), 3600, 1e-6);
  for (const Tetrahedron& t : piece.tets)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        const Vec3 &a = piece.nodes[t[i]], &b = piece.nodes[t[j]];
        EXPECT_LE((a - b).norm(), size(0.5 * (a + b)));
      }
}

TEST(PieceMesh, JoiningKeepsTheSolidAndItsSkin) {
  const TissuePiece fine = whole(slab(20, 4));
  PieceMesh mesh(fine);
  mesh.coarsen([](const Vec3& at) { return 4 + 0.5 * at.norm(); }, 10);
  const TissuePiece piece = mesh.piece();
  EXPECT_LT(piece.tets.size(), fine.tets.size() / 4);
  EXPECT_EQ(piece.nodes[0], fine.nodes[0]);
  const fem::TetMesh solid = linear_mesh(piece);
  EXPECT_NO_THROW(fem::check_mesh(solid));
  // The corners of the cut, 42 mm away, may be rounded by a twelfth of that.
  EXPECT_NEAR(volume_of(solid) / (60 * 60 * 8), 1, 0.02);
  EXPECT_NEAR(area_of(piece, piece.skin) / 3600, 1, 0.02);
  EXPECT_NEAR(area_of(piece, piece.held) / 3600, 1, 0.02);
  std::size_t kept = 0, near = 0;
  for (std::size_t n = 0; n < fine.nodes.size(); ++n)
    near += fine.skin[n] && fine.nodes[n].norm() < 10;
  for (std::size_t n = 0; n < piece.nodes.size(); ++n) {
    kept += piece.skin[n] && piece.nodes[n].norm() < 10;
    if (piece.skin[n]) EXPECT_EQ(piece.nodes[n].z(), 0);
    if (piece.held[n]) EXPECT_EQ(piece.nodes[n].z(), -8);
  }
  EXPECT_EQ(kept, near);
}

TEST(PieceMesh, ABisectedEdgeThroughFleshIsNotHeld) {
  TissuePiece one;  // two tetrahedra that share a face; all nodes but the tips are held
  one.nodes = {{0, 0, 5}, {6, 0, 0}, {0, 6, 0}, {-6, -6, 0}, {0, 0, -5}};
  one.held = {1, 1, 1, 1, 1};
  one.skin = {0, 0, 0, 0, 0};
  one.tets = {{1, 2, 3, 0}, {1, 3, 2, 4}};
  one.nodes.push_back({8, 8, 0});  // and a third one, so that edge (1, 2) has flesh all around
  one.held.push_back(1);
  one.skin.push_back(0);
  one.tets.push_back({1, 0, 2, 5});
  one.tets.push_back({1, 2, 4, 5});
  for (Tetrahedron& t : one.tets) {
    const Vec3& o = one.nodes[t[0]];
    if ((one.nodes[t[1]] - o).cross(one.nodes[t[2]] - o).dot(one.nodes[t[3]] - o) < 0)
      std::swap(t[2], t[3]);
  }
  PieceMesh mesh(one);
  mesh.refine([](const Vec3& at) { return (at - Vec3(3, 3, 0)).norm() < 1e-9 ? 1.0 : 100.0; }, 100);
  const TissuePiece out = mesh.piece();
  ASSERT_EQ(out.nodes.size(), 7u);
  EXPECT_EQ(out.nodes[6], Vec3(3, 3, 0));
  EXPECT_FALSE(out.held[6]);
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
