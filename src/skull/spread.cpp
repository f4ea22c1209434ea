// SPDX-License-Identifier: GPL-3.0-or-later
// With the energy's Hessian H = L L^T at the most probable map, L^-T z with z standard normal is a
// draw from the Gaussian that osculates the posterior. The individual's field is a stationary
// Gaussian process of unit variance with kernel exp(-r^2 / 2 range^2), drawn as random plane waves
// (Rahimi & Recht 2007, "Random features for large-scale kernel machines"), times the local spread.
#include "skull/spread.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "core/error.hpp"

namespace palpate::skull {
namespace {

constexpr int kWaves = 32;  ///< plane waves per field: kurtosis within 5 % of a Gaussian's

/// Standard normals with the same bits everywhere (Box & Muller 1958).
class Normals {
 public:
  explicit Normals(std::uint64_t seed) : bits_(seed) {}
  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }
  double operator()() {
    const double size = std::sqrt(-2 * std::log(uniform()));
    return size * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 bits_;
};

struct Wave {
  Vec3 number;  ///< [1/mm]
  double phase;
};

double field_at(const std::vector<Wave>& waves, const Vec3& x) {
  double sum = 0;
  for (const Wave& w : waves) sum += std::cos(w.number.dot(x) + w.phase);
  return std::sqrt(2.0 / static_cast<double>(waves.size())) * sum;
}

/// Variance [mm^2] of the map along the way to the skin at each point: a^T H^-1 a with a the
/// point's shares of the control points, and its motion with the jaw's pose, times the way. Points
/// of one lattice cell share their 195 rows.
std::vector<double> map_variance(const Eigen::LLT<Eigen::MatrixXd>& factor, const SkullMap& map,
                                 const std::vector<SplineWeights>& weights,
                                 const std::vector<JawMotion>& motion,
                                 const std::vector<SkinDepth>& depth) {
  const int controls = map.lattice.size();
  constexpr Eigen::Index kBlock = 128;  // columns that one task solves for, whatever the threads
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(3 * controls + 3, 3 * controls + 3);
  tbb::parallel_for(Eigen::Index{0}, (covariance.cols() + kBlock - 1) / kBlock, [&](auto b) {
    auto columns =
        covariance.middleCols(b * kBlock, std::min(kBlock, covariance.cols() - b * kBlock));
    factor.solveInPlace(columns);
  });
  std::map<std::int32_t, std::vector<std::size_t>> cells;
  for (std::size_t v = 0; v < weights.size(); ++v) cells[weights[v].control[0]].push_back(v);
  std::vector<const std::vector<std::size_t>*> all;
  for (const auto& [first, members] : cells) all.push_back(&members);
  std::vector<double> variance(weights.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t cell) {
    const std::vector<std::size_t>& members = *all[cell];
    const auto& control = weights[members.front()].control;
    const auto place = [&](int q) {
      return q < 192 ? q / 64 * controls + control[q % 64] : 3 * controls + q - 192;
    };
    Eigen::MatrixXd block(195, 195), along(195, members.size());
    for (int q = 0; q < 195; ++q)
      for (int r = 0; r < 195; ++r) block(r, q) = covariance(place(r), place(q));
    for (std::size_t i = 0; i < members.size(); ++i) {
      const std::size_t v = members[i];
      const Vec3 inner = map.linear.transpose() * depth[v].gradient;
      const Vec3 way = motion[v].turn.transpose() * inner;
      for (int r = 0; r < 192; ++r) along(r, i) = weights[v].share[r % 64] * way[r / 64];
      along.col(i).tail<3>() = motion[v].by_pose.transpose() * inner;
    }
    const Eigen::MatrixXd spread = block * along;
    for (std::size_t i = 0; i < members.size(); ++i)
      variance[members[i]] = along.col(i).dot(spread.col(i));
  });
  return variance;
}

}  // namespace

SkullSpread draw_spread(const SkullTemplate& skull, const std::vector<Vec3>& fitted,
                        const DepthFit& solved, const DepthModel& model, const SkinField& skin,
                        const SpreadOptions& options) {
  const Eigen::LLT<Eigen::MatrixXd> factor(solved.information);
  if (factor.info() != Eigen::Success)
    throw SolveError("the fit's uncertainty could not be computed: its Hessian is not definite");
  const std::size_t n = fitted.size();
  std::vector<SplineWeights> weights;
  std::vector<JawMotion> motion;
  for (const Vec3& p : skull.mesh.points) {
    weights.push_back(solved.map.lattice.weights(p));
    motion.push_back(move_jaw(solved.map.jaw, solved.map.pose, solved.map.shaped(p, weights.back()),
                              solved.map.jaw.weight(p)));
  }
  std::vector<SkinDepth> depth(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) { depth[v] = skin.at(fitted[v]); });
  const std::vector<double> of_map = map_variance(factor, solved.map, weights, motion, depth);
  std::vector<double> own(n);  // what the map does not show of the table's whole spread
  SkullSpread out{std::vector<double>(n), {}};
  for (std::size_t v = 0; v < n; ++v) {
    const double whole =
        depth[v].completed ? std::hypot(model.sd[v], options.completed_sd) : model.sd[v];
    own[v] = std::sqrt(std::max(0.0, whole * whole - of_map[v]));
    out.deviation[v] = std::hypot(std::sqrt(of_map[v]), own[v]);
  }
  Normals normal(options.seed), of_jaw(~options.seed);
  const int controls = solved.map.lattice.size();
  for (int k = 0; k < options.draws; ++k) {
    Eigen::VectorXd z(3 * controls + 3);
    for (double& x : z.head(3 * controls)) x = normal();
    for (double& x : z.tail<3>()) x = of_jaw();
    const Eigen::VectorXd step = factor.matrixU().solve(z);
    const Eigen::Map<const Eigen::MatrixX3d> control(step.data(), controls, 3);
    std::vector<Wave> waves(kWaves);
    for (Wave& w : waves) {
      const double x = normal(), y = normal(), zz = normal();
      w = {Vec3(x, y, zz) / options.range, 2 * std::numbers::pi * normal.uniform()};
    }
    std::vector<Vec3> offset(n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t v) {
      Vec3 u = Vec3::Zero();
      for (int c = 0; c < 64; ++c)
        u += weights[v].share[c] * control.row(weights[v].control[c]).transpose();
      const Vec3 moved =
          solved.map.linear * (motion[v].turn * u + motion[v].by_pose * step.tail<3>());
      const Vec3& inward = depth[v].gradient;
      const double along = inward.dot(moved);
      const double up = std::min(0.0, options.least_depth - depth[v].depth);  // as far as it may go
      const double wanted = along + own[v] * field_at(waves, skull.mesh.points[v]);
      offset[v] = moved + (std::max(wanted, up) - along) * inward;
    });
    out.offset.push_back(std::move(offset));
  }
  return out;
}

}  // namespace palpate::skull
