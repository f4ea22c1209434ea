// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetmesh/tissue.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <fstream>
#include <numbers>

#include "core/error.hpp"
#include "scenes.hpp"
#include "tetmesh/process.hpp"

namespace palpate::tetmesh {
namespace {

using scenes::sphere;

HeadSurface ball_head(double radius = 40, int levels = 4) {
  HeadSurface head;
  head.skin = sphere(radius, levels);
  head.region.assign(head.skin.points.size(), SkinRegion::other);
  return head;
}
SkullFit ball_skull(double radius = 28, const Vec3& centre = Vec3::Zero(), int levels = 4) {
  SkullFit fit;
  fit.mesh = sphere(radius, levels, centre);
  return fit;
}
TissueOptions coarse() {
  TissueOptions o;
  o.max_volume = 30;
  return o;
}
/// A mesher that never ends and writes a lot.
struct EndlessMesher {
  TemporaryFolder folder;
  std::string path = (folder.path() / "mesher").string();
  EndlessMesher() {
    std::ofstream(path) << "#!/bin/sh\nyes working\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
};
std::string refusal(const HeadSurface& head, const SkullFit& skull, TissueOptions o = coarse()) {
  try {
    (void)make_tissue_mesh(head, skull, o);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(TissueMesh, ConcentricSpheresHaveTheShellsVolumes) {
  const auto head = ball_head();
  const auto skull = ball_skull();
  const TissueMesh mesh = make_tissue_mesh(head, skull, coarse());
  const auto ball = [](double r) { return 4.0 / 3 * std::numbers::pi * r * r * r; };
  EXPECT_NEAR(mesh.quality.at("volume_bone_mm3") / ball(28), 1, 0.01);
  EXPECT_NEAR(mesh.quality.at("volume_flesh_mm3") / (ball(40) - ball(28)), 1, 0.01);
  // The facets are kept, so that the polyhedra's own volumes are met to rounding.
  EXPECT_NEAR(mesh.quality.at("volume_bone_mm3"), signed_volume(skull.mesh), 1e-6);
  EXPECT_NEAR(mesh.quality.at("volume_flesh_mm3"), mesh.quality.at("volume_between_mm3"), 1e-6);
}

TEST(TissueMesh, FirstNodesAreTheSkinThenTheSkullBitForBit) {
  const auto head = ball_head();
  const auto skull = ball_skull(28, {1, 2, 0.3});
  const TissueMesh mesh = make_tissue_mesh(head, skull, coarse());
  ASSERT_EQ(mesh.skin_points, head.skin.points.size());
  for (std::size_t i = 0; i < mesh.skin_points; ++i) EXPECT_EQ(mesh.nodes[i], head.skin.points[i]);
  for (std::size_t i = 0; i < skull.mesh.points.size(); ++i)
    EXPECT_EQ(mesh.nodes[mesh.skin_points + i], skull.mesh.points[i]);
}

TEST(TissueMesh, EveryTetHasPositiveVolumeAndTheLabelOfItsPlace) {
  const TissueMesh mesh = make_tissue_mesh(ball_head(), ball_skull(), coarse());
  ASSERT_EQ(mesh.label.size(), mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    Mat3 edges;
    Vec3 centre = mesh.nodes[mesh.tets[t][0]] / 4;
    for (int i = 0; i < 3; ++i) {
      edges.col(i) = mesh.nodes[mesh.tets[t][i + 1]] - mesh.nodes[mesh.tets[t][0]];
      centre += mesh.nodes[mesh.tets[t][i + 1]] / 4;
    }
    EXPECT_GT(edges.determinant(), 0);
    if (std::abs(centre.norm() - 28) > 0.5) {
      EXPECT_EQ(mesh.label[t], centre.norm() < 28 ? TissueLabel::bone : TissueLabel::flesh);
    }
  }
}

TEST(TissueMesh, HoldsBoneOrgansAndSkinFarFromBone) {
  auto head = ball_head();
  for (std::size_t i = 0; i < head.skin.points.size(); ++i)
    if (head.skin.points[i].z() > 35) head.region[i] = SkinRegion::nose;
  // A small skull low in the ball: the upper skin's inward normals pass more than 40 mm of flesh.
  const auto skull = ball_skull(10, {0, -20, 0}, 3);
  const TissueMesh mesh = make_tissue_mesh(head, skull, coarse());
  std::size_t free_nodes = 0;
  for (std::size_t i = 0; i < mesh.skin_points; ++i) {
    const Vec3& p = mesh.nodes[i];
    if (p.z() > 35 || p.y() > 30) {
      EXPECT_EQ(mesh.held[i], 1) << p.transpose();
    } else if (p.y() < -39) {
      EXPECT_EQ(mesh.held[i], 0) << p.transpose();
    }
    free_nodes += mesh.held[i] == 0;
  }
  EXPECT_GT(free_nodes, 0U);
  for (std::size_t i = 0; i < skull.mesh.points.size(); ++i)
    EXPECT_EQ(mesh.held[mesh.skin_points + i], 1);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (mesh.label[t] == TissueLabel::bone) {
      for (const auto n : mesh.tets[t]) EXPECT_EQ(mesh.held[n], 1);
    }
}

TEST(TissueMesh, TwoBonesAreBothBone) {
  auto skull = ball_skull(12, {-16, 0, 0}, 3);
  const SurfaceMesh second = sphere(10, 3, {18, 0, 0});
  const auto base = static_cast<std::int32_t>(skull.mesh.points.size());
  skull.mesh.points.insert(skull.mesh.points.end(), second.points.begin(), second.points.end());
  for (const auto& [a, b, c] : second.triangles)
    skull.mesh.triangles.push_back({a + base, b + base, c + base});
  const TissueMesh mesh = make_tissue_mesh(ball_head(), skull, coarse());
  EXPECT_NEAR(mesh.quality.at("volume_bone_mm3"), signed_volume(skull.mesh), 1e-6);
}

TEST(TissueMesh, QualityOfTheRegularTetrahedron) {
  TissueMesh mesh;
  mesh.nodes = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.label = {TissueLabel::flesh};
  Mat3 edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = mesh.nodes[i + 1] - mesh.nodes[0];
  if (edges.determinant() < 0) std::swap(mesh.tets[0][0], mesh.tets[0][1]);
  measure_quality(mesh);
  EXPECT_NEAR(mesh.quality.at("dihedral_min_deg"), 70.528779, 1e-6);
  EXPECT_NEAR(mesh.quality.at("dihedral_max_deg"), 70.528779, 1e-6);
  EXPECT_DOUBLE_EQ(mesh.quality.at("dihedral_share_070_080"), 1);
  EXPECT_NEAR(mesh.quality.at("volume_flesh_mm3"), 8.0 / 3, 1e-12);
}

TEST(TissueMesh, SameBitsTwice) {
  const auto a = make_tissue_mesh(ball_head(), ball_skull(), coarse());
  const auto b = make_tissue_mesh(ball_head(), ball_skull(), coarse());
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.tets, b.tets);
  EXPECT_EQ(a.quality, b.quality);
}

TEST(TissueMesh, RefusesASkullThatPiercesTheSkin) {
  const std::string message = refusal(ball_head(), ball_skull(28, {20, 0, 0}));
  EXPECT_NE(message.find("meets skull triangle"), std::string::npos) << message;
  EXPECT_NE(message.find("inside the skin"), std::string::npos) << message;
}

TEST(TissueMesh, RefusesASkullBesideTheSkin) {
  EXPECT_NE(refusal(ball_head(), ball_skull(10, {100, 0, 0}, 3)), "");
}

TEST(TissueMesh, RefusesOpenOrInvertedSurfaces) {
  auto skull = ball_skull();
  skull.mesh.triangles.erase(skull.mesh.triangles.begin() + 7);
  EXPECT_NE(refusal(ball_head(), skull).find("skull is open at triangle"), std::string::npos);
  skull = ball_skull();
  for (auto& t : skull.mesh.triangles) std::swap(t[0], t[1]);
  EXPECT_NE(refusal(ball_head(), skull).find("inside out"), std::string::npos);
}

TEST(TissueMesh, NamesThePackageWhenTheMesherIsMissing) {
  auto o = coarse();
  o.mesher = "no-such-mesher-anywhere";
  EXPECT_NE(refusal(ball_head(), ball_skull(), o).find("apt install tetgen"), std::string::npos);
}

TEST(TissueMesh, ReportsAMesherThatFailsOrHangsOrWritesNothing) {
  auto o = coarse();
  o.mesher = "false";
  EXPECT_THROW((void)make_tissue_mesh(ball_head(), ball_skull(), o), SolveError);
  o.mesher = "true";
  EXPECT_THROW((void)make_tissue_mesh(ball_head(), ball_skull(), o), SolveError);
  const EndlessMesher endless;
  o.mesher = endless.path;
  o.time_limit = 0.3;
  EXPECT_THROW((void)make_tissue_mesh(ball_head(), ball_skull(), o), SolveError);
}

TEST(TissueMesh, StopsTheMesherWhenTheUserStops) {
  int steps = 0;
  const Progress progress([&](std::string_view, double) {
    if (++steps > 4) throw Cancelled();
  });
  auto o = coarse();
  const EndlessMesher endless;
  o.mesher = endless.path;
  EXPECT_THROW((void)make_tissue_mesh(ball_head(), ball_skull(), o, progress), Cancelled);
}

TEST(TissueMesh, RefusesOptionsOutOfRange) {
  auto o = coarse();
  o.max_volume = 0;
  EXPECT_NE(refusal(ball_head(), ball_skull(), o), "");
  o = coarse();
  o.radius_edge_ratio = 1;
  EXPECT_NE(refusal(ball_head(), ball_skull(), o), "");
}

}  // namespace
}  // namespace palpate::tetmesh
