// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/sites.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace palpate::stiffness {
namespace {

Eigen::MatrixXd square_of_points(int n) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> d(0, 1);
  Eigen::MatrixXd m(n, 2);
  for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = d(random);
  return m;
}

TEST(FarthestPoints, AreDistinctAndFewerAreAPrefixOfMore) {
  const Eigen::MatrixXd points = square_of_points(500);
  const auto many = farthest_points(points, 60, 3), few = farthest_points(points, 20, 3);
  EXPECT_EQ(std::set<int>(many.begin(), many.end()).size(), 60u);
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  EXPECT_EQ(farthest_points(points, 900, 3).size(), 500u);
  EXPECT_TRUE(farthest_points(Eigen::MatrixXd(0, 2), 5, 3).empty());
}

// Greedy k-centre: no point is farther from its site than the sites are from each other.
TEST(FarthestPoints, CoverAtLeastAsWellAsTheySpread) {
  const Eigen::MatrixXd points = square_of_points(500);
  const auto sites = farthest_points(points, 40, 3);
  double spread = 1e9, cover = 0;
  for (std::size_t i = 0; i < sites.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      spread = std::min(spread, (points.row(sites[i]) - points.row(sites[j])).norm());
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    double nearest = 1e9;
    for (const auto s : sites) nearest = std::min(nearest, (points.row(p) - points.row(s)).norm());
    cover = std::max(cover, nearest);
  }
  EXPECT_LE(cover, spread + 1e-12);
}

}  // namespace
}  // namespace palpate::stiffness
