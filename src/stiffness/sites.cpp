// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/sites.hpp"

#include <algorithm>
#include <limits>
#include <random>

namespace palpate::stiffness {

std::vector<std::int32_t> farthest_points(const Eigen::MatrixXd& inputs, int count,
                                          std::uint64_t seed) {
  const Eigen::Index n = inputs.rows();
  std::vector<std::int32_t> chosen;
  if (n == 0) return chosen;
  const Eigen::MatrixXd columns = inputs.transpose();  // one point per column: contiguous
  Eigen::VectorXd squared = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  std::mt19937_64 random(seed);
  Eigen::Index next = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(n));
  while (static_cast<Eigen::Index>(chosen.size()) < std::min<Eigen::Index>(count, n)) {
    chosen.push_back(static_cast<std::int32_t>(next));
    for (Eigen::Index i = 0; i < n; ++i)
      squared[i] = std::min(squared[i], (columns.col(i) - columns.col(next)).squaredNorm());
    squared[next] = -1;
    squared.maxCoeff(&next);
  }
  return chosen;
}

std::vector<std::int32_t> choose_sites(const Ground& ground,
                                       const std::vector<std::int32_t>& tissue, int count) {
  if (count >= static_cast<int>(tissue.size())) return tissue;
  // What moves the curve most counts most: depths and curvatures in full, their unevenness around
  // the site less; position in addition, so that no part of the head is left without a site.
  constexpr double kUnevenness = 0.3;  // [-]
  constexpr double kPosition = 0.35;   // [-] per tool radius; more spreads sites evenly in space
  const Eigen::Index s = ground.spots[tissue[0]].shape.size();
  Eigen::RowVectorXd weight = Eigen::RowVectorXd::Ones(s);
  for (Eigen::Index r = 1; r < s; r += 5)
    weight[r + 1] = weight[r + 2] = weight[r + 4] = kUnevenness;
  Eigen::MatrixXd inputs(tissue.size(), s + 3);
  for (std::size_t i = 0; i < tissue.size(); ++i) {
    const Spot& spot = ground.spots[tissue[i]];
    inputs.row(i).head(s) = spot.shape.transpose().cwiseProduct(weight);
    inputs.row(i).tail(3) = kPosition / ground.options.tool_radius * spot.frame.origin;
  }
  std::vector<std::int32_t> sites = farthest_points(inputs, count, ground.options.seed);
  for (std::int32_t& i : sites) i = tissue[i];
  return sites;
}

}  // namespace palpate::stiffness
