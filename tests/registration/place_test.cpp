// SPDX-License-Identifier: GPL-3.0-or-later
#include "registration/place.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"

namespace palpate::registration {
namespace {

Vec3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

std::vector<PointPair> random_pairs(std::mt19937& random, const Mat3& linear, const Vec3& shift) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < 5; ++i) {
    const Vec3 p = random_point(random, 100);
    pairs.push_back({"pair " + std::to_string(i), p, linear * p + shift});
  }
  return pairs;
}

TEST(Placement, RecoversARandomSimilarityExactly) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Mat3 turn = Eigen::AngleAxisd(0.1 + trial * 0.06, random_point(random, 1).normalized())
                          .toRotationMatrix();
    const double scale = 0.5 + 0.02 * trial;
    const Vec3 shift = random_point(random, 500);
    const Placement found = fit_similarity(random_pairs(random, scale * turn, shift));
    EXPECT_LT((found.linear - scale * turn).norm(), 1e-12);
    EXPECT_LT((found.translation - shift).norm(), 1e-9);
    EXPECT_LT(found.rms_mm, 1e-10);
  }
}

TEST(Placement, RigidKeepsTheScaleAndReportsWhatIsLeft) {
  std::mt19937 random(2);
  const std::vector<PointPair> pairs = random_pairs(random, 1.1 * Mat3::Identity(), Vec3(5, 6, 7));
  const Placement found = fit_rigid(pairs);
  EXPECT_NEAR(found.linear.determinant(), 1, 1e-12);
  double squares = 0;
  for (const PointPair& p : pairs) {
    EXPECT_NEAR(found.residuals_mm.at(p.name), (p.to - found(p.from)).norm(), 1e-12);
    squares += (p.to - found(p.from)).squaredNorm();
  }
  EXPECT_NEAR(found.rms_mm, std::sqrt(squares / pairs.size()), 1e-12);
}

TEST(Placement, LeavesTheLeastSquareDistanceOfAllSmallMotions) {
  std::mt19937 random(3);
  std::vector<PointPair> pairs = random_pairs(random, Mat3::Identity(), Vec3::Zero());
  for (PointPair& p : pairs) p.to += random_point(random, 8);
  const Placement best = fit_similarity(pairs);
  const auto cost = [&](const Mat3& a, const Vec3& t) {
    double sum = 0;
    for (const PointPair& p : pairs) sum += (p.to - a * p.from - t).squaredNorm();
    return sum;
  };
  const double least = cost(best.linear, best.translation);
  for (int trial = 0; trial < 100; ++trial) {
    const Mat3 turn =
        Eigen::AngleAxisd(1e-3, random_point(random, 1).normalized()).toRotationMatrix();
    EXPECT_GT(cost((1 + 1e-3 * (trial % 3 - 1)) * turn * best.linear,
                   best.translation + random_point(random, 0.05)),
              least);
  }
}

TEST(Placement, NeverMirrors) {
  std::mt19937 random(4);
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const std::vector<PointPair> pairs = random_pairs(random, mirror, Vec3::Zero());
  EXPECT_NEAR(fit_rigid(pairs).linear.determinant(), 1, 1e-12);
  EXPECT_GT(fit_similarity(pairs).linear.determinant(), 0);
}

TEST(Placement, FivePointsInAPlaneAreEnough) {
  const std::vector<PointPair> pairs = {
      {"a", {0, 0, 0}, {0, 0, 1}}, {"b", {1, 0, 0}, {0, 1, 1}}, {"c", {0, 1, 0}, {-1, 0, 1}}};
  const Placement found = fit_rigid(pairs);
  EXPECT_LT(found.rms_mm, 1e-12);
  EXPECT_NEAR(found.linear.determinant(), 1, 1e-12);
}

TEST(Placement, RefusesPairsThatFixNoRotation) {
  std::vector<PointPair> line;
  for (int i = 0; i < 5; ++i) line.push_back({"p", Vec3(i, 2 * i, 3 * i), Vec3(i, 0, 0)});
  EXPECT_THROW(fit_rigid(line), InputError);
  EXPECT_THROW(fit_similarity(std::span(line).first(2)), InputError);
}

HeadSurface box_head(const Vec3& size) {
  HeadSurface head;
  for (int i = 0; i < 8; ++i)
    head.skin.points.emplace_back((i & 1) * size.x(), (i & 2) / 2 * size.y(),
                                  (i & 4) / 4 * size.z());
  head.skin.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                         {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  head.filled.assign(8, 0);
  head.region.assign(8, SkinRegion::other);
  return head;
}

TEST(Placement, PublishedScalesEachAxisAndThenMovesRigidly) {
  // The caps' flat faces would count as the end of a scan: turn that off by a landmark low enough.
  HeadSurface head = box_head({15, 30, 24});
  SkullTemplate skull;
  skull.mesh = box_head({10, 10, 10}).skin;
  const std::vector<std::pair<const char*, Vec3>> marks = {{"nose_tip", {5, 4, 10}},
                                                           {"nose_corner_left", {6, 4, 9}},
                                                           {"nose_corner_right", {4, 4, 9}},
                                                           {"eye_outer_left", {8, 7, 8}},
                                                           {"eye_outer_right", {2, 7, 8}}};
  for (const auto& [name, p] : marks) {
    skull.registration_points[name] = p;
    head.landmarks[name] = {Vec3(1.5, 1.5, 2.4).cwiseProduct(p) + Vec3(0, 2000, 0), 1};
  }
  head.skin.points[0].y() = 0;
  for (Vec3& p : head.skin.points) p.y() += 2000;
  const Placement found = place_published(head, skull);
  EXPECT_EQ(found.warnings.size(), 1u);  // 6 mm below the nose tip the box ends
  // linear = rotation * diag(scales): the scales are the lengths of the columns.
  EXPECT_NEAR(found.linear.col(0).norm(), 1.5, 1e-9);
  EXPECT_NEAR(found.linear.col(2).norm(), 2.4, 1e-9);
  EXPECT_NEAR(found.linear.col(1).norm(), 0.5 * (1.5 + 2.4), 1e-9);
  head.landmarks.erase("nose_tip");
  EXPECT_THROW(place_published(head, skull), InputError);
}

TEST(Placement, MovesATemplateWithItsMarks) {
  SkullTemplate skull;
  skull.mesh = box_head({1, 1, 1}).skin;
  skull.landmarks["v"] = {{0, 1, 0}, Vec3(1, 1, 0).normalized()};
  skull.registration_points["nose_tip"] = {0, 0, 1};
  Placement stretch;
  stretch.linear = Vec3(2, 1, 1).asDiagonal();
  stretch.translation = {1, 2, 3};
  const SkullTemplate moved = placed(skull, stretch);
  EXPECT_EQ(moved.landmarks.at("v").position, Vec3(1, 3, 3));
  EXPECT_NEAR(moved.landmarks.at("v").normal.y() / moved.landmarks.at("v").normal.x(), 2, 1e-12);
  EXPECT_EQ(moved.registration_points.at("nose_tip"), Vec3(1, 2, 4));
  EXPECT_EQ(moved.mesh.points[1], Vec3(3, 2, 3));
}

}  // namespace
}  // namespace palpate::registration
