// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "scenes.hpp"
#include "stiffness/published_sites.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {
namespace {
namespace fs = std::filesystem;

/// A slab of flesh, 2 x 2 x 1 cells of 10 x 10 x 8 mm, skin on top, bone below; node 0 is the
/// middle of the skin.
TissuePiece slab() {
  TissuePiece piece;
  for (const double z : {0.0, -8.0})
    for (const auto& [x, y] :
         {std::pair{0, 0}, {-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}) {
      piece.nodes.push_back({10.0 * x, 10.0 * y, z});
      piece.held.push_back(z < 0);
      piece.skin.push_back(z == 0);
    }
  // Skin triangles around the middle, each a prism of three tetrahedra cut by lowest numbers.
  constexpr std::array<std::array<int, 2>, 8> kRim = {
      {{1, 2}, {2, 3}, {3, 5}, {5, 8}, {8, 7}, {7, 6}, {6, 4}, {4, 1}}};
  for (const auto& [a, b] : kRim) {
    const int low = std::min(a, b), high = std::max(a, b);
    for (Tetrahedron t :
         {Tetrahedron{0, low, high, high + 9}, Tetrahedron{0, low, low + 9, high + 9},
          Tetrahedron{0, 9, low + 9, high + 9}}) {
      const Vec3& o = piece.nodes[t[0]];
      if ((piece.nodes[t[1]] - o).cross(piece.nodes[t[2]] - o).dot(piece.nodes[t[3]] - o) < 0)
        std::swap(t[2], t[3]);
      piece.tets.push_back(t);
    }
  }
  return piece;
}

TEST(Published, GentleForcesGiveACurveStrongOnesAreMarkedAndGiveNone) {
  const SiteCurve gentle = press_as_published(slab(), std::vector<double>{0.01, 0.02});
  ASSERT_EQ(gentle.travel.size(), 2u);
  EXPECT_EQ(published_status(gentle), VertexStatus::solved);
  EXPECT_EQ(gentle.method, SolveMethod::published);
  EXPECT_NEAR(gentle.travel[1] / gentle.travel[0], 2, 0.1);  // nearly linear down there

  int calls = 0;
  const SiteCurve strong =
      press_as_published(slab(), std::vector<double>{0.02, 5, 6}, [&calls] { ++calls; });
  EXPECT_EQ(calls, 2);
  EXPECT_TRUE(strong.travel.empty());
  EXPECT_EQ(published_status(strong), VertexStatus::inverted);
  ASSERT_EQ(strong.published.size(), 2u);
  EXPECT_EQ(strong.published[0].inverted_tets, 0);
  EXPECT_EQ(strong.published[0].displacement, gentle.travel[1]);  // each force on its own
  EXPECT_GT(strong.published[1].inverted_tets, 0);
}

TEST(Published, StatusNamesTheWorstThatHappened) {
  SiteCurve c;
  EXPECT_EQ(published_status(c), VertexStatus::failed);
  c.published = {{1, false, 0, 300}};
  EXPECT_EQ(published_status(c), VertexStatus::unsettled);
  c.published.push_back({2, true, 3, 10});
  EXPECT_EQ(published_status(c), VertexStatus::inverted);
}

TEST(Published, ThePieceStartsAtTheNearestNodeThatMayMove) {
  const TissuePiece cut = slab();
  TissueMesh tissue;
  tissue.nodes = cut.nodes;
  tissue.tets = cut.tets;
  tissue.held = cut.held;
  tissue.label.assign(cut.tets.size(), TissueLabel::flesh);
  tissue.skin_points = 9;
  tissue.held[0] = 1;  // an organ's
  const TissueCutter cutter(tissue);
  const SiteFrame frame = site_frame({3, 0, 0}, Vec3::UnitZ());
  using Start = TissueCutter::Start;
  EXPECT_EQ(frame.origin + frame.axes * cutter.take(frame, 40, 8, Start::any).nodes[0],
            tissue.nodes[0]);
  const TissuePiece piece = cutter.take(frame, 40, 8, Start::free);
  EXPECT_EQ(frame.origin + frame.axes * piece.nodes[0], tissue.nodes[5]);
  EXPECT_EQ(piece.tets.size(), tissue.tets.size());
  EXPECT_THROW((void)cutter.take(frame, 40, 5, Start::free), SolveError);
}

class PublishedSweep : public testing::Test {
 protected:
  static SweepOptions options(double max_force) {
    SweepOptions o;
    o.mode = SweepMode::published;
    o.sites = 6;
    o.loads = 2;
    o.max_force = max_force;
    o.published.max_volume = 300;
    return o;
  }
  const scenes::Head head = scenes::head(3);
};

TEST_F(PublishedSweep, GentleForcesMapTheHead) {
  const Sweep s = sweep(head.skin, head.skull, options(0.01));
  ASSERT_EQ(s.published.size(), 6u);
  EXPECT_EQ(s.statistics.at("sites_solved"), 6);
  EXPECT_EQ(s.statistics.at("sites_inverted_at_00.010_n"), 0);
  EXPECT_TRUE(s.warnings.empty());
  EXPECT_TRUE(s.map.dents.radii.empty());
  for (const auto p : s.sites) {
    EXPECT_EQ(s.map.status[p], VertexStatus::solved);
    EXPECT_EQ(s.map.method[p], SolveMethod::published);
    EXPECT_TRUE(std::isnan(s.map.error[p]));  // a force on a node has no limit to err from
  }
  for (std::size_t p = 0; p < s.map.size(); ++p) {
    ASSERT_TRUE(s.map.has_curve(p));
    EXPECT_GT(s.map.curve(p)[1], s.map.curve(p)[0]);
  }
}

TEST_F(PublishedSweep, TissueTurnedInsideOutIsSaidAtEveryPoint) {
  const Sweep s = sweep(head.skin, head.skull, options(20));
  EXPECT_EQ(s.statistics.at("sites_inverted"), 6);
  EXPECT_EQ(s.statistics.at("sites_inverted_at_20.000_n"), 6);
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_NE(s.warnings[0].find("inside out"), std::string::npos);
  for (std::size_t p = 0; p < s.map.size(); ++p) {
    EXPECT_EQ(s.map.status[p], VertexStatus::inverted);
    EXPECT_TRUE(std::isnan(s.map.curve(p)[0]));
  }
  EXPECT_EQ(s.map.method[s.sites[0]], SolveMethod::published);
  EXPECT_EQ(std::count(s.map.method.begin(), s.map.method.end(), SolveMethod::published), 6);
  for (const PublishedSite& site : s.published) {
    ASSERT_FALSE(site.samples.empty());
    EXPECT_GT(site.samples.back().inverted_tets, 0);
  }
}

TEST_F(PublishedSweep, ShardsAndCheckpointsGiveTheSameBits) {
  const fs::path folder = fs::path(testing::TempDir()) / "palpate_published_shards";
  fs::remove_all(folder);
  fs::create_directories(folder);
  SweepOptions o = options(0.01);
  o.threads = 1;
  const Sweep whole = sweep(head.skin, head.skull, o);
  for (int i = 0; i < 2; ++i) {
    SweepOptions part = o;
    part.shard = i;
    part.shard_count = 2;
    part.checkpoint = folder / std::to_string(i);
    EXPECT_EQ(sweep(head.skin, head.skull, part).statistics.at("curves_in_store"), 3);
  }
  SweepOptions merge = o;
  merge.parts = {folder / "0", folder / "1"};
  const Sweep merged = sweep(head.skin, head.skull, merge);
  SweepOptions resume = o;
  resume.checkpoint = folder / "0";
  const Sweep resumed = sweep(head.skin, head.skull, resume);
  for (const Sweep* s : {&merged, &resumed}) {
    EXPECT_EQ(s->map.displacement, whole.map.displacement);
    EXPECT_EQ(s->statistics, whole.statistics);
    for (std::size_t i = 0; i < whole.published.size(); ++i)
      EXPECT_EQ(s->published[i].samples[1].steps, whole.published[i].samples[1].steps);
  }
  SweepOptions other = resume;
  other.published.reach = 20;
  EXPECT_THROW((void)sweep(head.skin, head.skull, other), InputError);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace palpate::stiffness
