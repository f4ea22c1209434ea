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

}  // namespace palpate::stiffness
