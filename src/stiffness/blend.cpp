// SPDX-License-Identifier: GPL-3.0-or-later
// Rasmussen & Williams 2006, "Gaussian Processes for Machine Learning": sections 2.7 (trend), 4.2.1
// (Matern 5/2) and 5.4.2 (leave-one-out: the residual is alpha_i / (K^-1)_ii, the variance
// 1 / (K^-1)_ii).
//
// The trend is linear in the shape numbers; each number then enters the kernel in proportion to its
// weight in the trend, so that what moves the curve most is resolved finest.
#include "stiffness/blend.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::stiffness {
namespace {

constexpr double kRidge = 1e-3;        // [-] on standardised inputs: keeps the trend tame
constexpr double kLeastWeight = 0.05;  // [-] of the largest: no input is ignored
constexpr int kKernelRounds = 3;       // rounds of coordinate search; more changes the third digit

double matern52(double r) {
  const double a = std::sqrt(5.0) * r;
  return (1 + a + a * a / 3) * std::exp(-a);
}

double covariance_of(double shape_distance, double position_distance, const BlendKernel& k) {
  const double place = matern52(position_distance / k.position_scale);
  return (1 - k.position_share) * matern52(shape_distance / k.shape_scale) +
         k.position_share * place;
}

Eigen::MatrixXd to_logarithms(const Eigen::MatrixXd& travel) {
  Eigen::MatrixXd y = travel;
  for (Eigen::Index c = travel.cols() - 1; c > 0; --c) y.col(c) -= travel.col(c - 1);
  return y.array().log();
}

Eigen::MatrixXd to_travel(const Eigen::MatrixXd& logarithms) {
  Eigen::MatrixXd u = logarithms.array().exp();
  for (Eigen::Index c = 1; c < u.cols(); ++c) u.col(c) += u.col(c - 1);
  return u;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
  return v[v.size() / 2];
}

}  // namespace

CurveBlend::CurveBlend(BlendInputs sites, const Eigen::MatrixXd& travel,
                       const Eigen::MatrixXd& others)
    : sites_(std::move(sites)), travel_(travel), others_(others) {
  const Eigen::Index n = travel.rows(), s = sites_.shape.cols();
  mean_ = sites_.shape.colwise().mean();
  inverse_deviation_ =
      ((sites_.shape.rowwise() - mean_.transpose()).array().square().colwise().sum() /
       static_cast<double>(n))
          .sqrt()
          .max(1e-9)
          .inverse();
  Eigen::MatrixXd basis(n, 1 + s);
  basis.col(0).setOnes();
  basis.rightCols(s) =
      (sites_.shape.rowwise() - mean_.transpose()) * inverse_deviation_.asDiagonal();
  Eigen::MatrixXd y = to_logarithms(travel);
  if (sites_.guess.size() > 0) y -= to_logarithms(sites_.guess);
  Eigen::MatrixXd normal = basis.transpose() * basis;
  normal.diagonal().tail(s).array() += kRidge * static_cast<double>(n);
  trend_ = normal.ldlt().solve(basis.transpose() * y);
  target_ = y - basis * trend_;

  weight_ = trend_.bottomRows(s).rowwise().norm();
  weight_ = (weight_ / std::max(weight_.maxCoeff(), 1e-12)).cwiseMax(kLeastWeight);
  sites_.shape = basis.rightCols(s) * weight_.asDiagonal();
  choose_kernel();
  if (others_.size() == 0) return;
  others_mean_ = others_.colwise().mean();
  others_alpha_ = factor_.solve(others_.rowwise() - others_mean_);
}

Eigen::VectorXd CurveBlend::scaled_shape(const Eigen::VectorXd& shape) const {
  return (shape - mean_).cwiseProduct(inverse_deviation_).cwiseProduct(weight_);
}

Eigen::MatrixXd CurveBlend::covariance(const BlendKernel& kernel) const {
  const Eigen::Index n = sites_.shape.rows();
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = j; i < n; ++i)
      K(i, j) = covariance_of((sites_.shape.row(i) - sites_.shape.row(j)).norm(),
                              (sites_.position.row(i) - sites_.position.row(j)).norm(), kernel);
  K.diagonal().array() += kernel.noise;
  return K;
}

double CurveBlend::fit(const BlendKernel& kernel) {
  const Eigen::Index n = travel_.rows();
  factor_.compute(covariance(kernel));
  alpha_ = factor_.solve(target_);
  const Eigen::VectorXd precision = factor_.solve(Eigen::MatrixXd::Identity(n, n)).diagonal();
  const Eigen::MatrixXd miss = precision.cwiseInverse().asDiagonal() * alpha_;
  const Eigen::MatrixXd predicted = to_travel(to_logarithms(travel_) - miss);
  left_out_ = (predicted - travel_).cwiseQuotient(travel_);

  std::vector<double> error(n), ratio(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    error[i] = std::sqrt(left_out_.row(i).squaredNorm() / static_cast<double>(travel_.cols()));
    ratio[i] = error[i] * std::sqrt(precision[i]);
  }
  constexpr double kMedianOfNormal = 0.6745;  // of |x| for a unit normal
  calibration_ = median(ratio) / kMedianOfNormal;
  return median(error);
}

void CurveBlend::choose_kernel() {
  BlendKernel best;
  double best_error = fit(best);
  const auto attempt = [&](BlendKernel trial) {
    const double error = fit(trial);
    if (error < best_error) best_error = error, best = trial;
  };
  for (int round = 0; round < kKernelRounds; ++round) {
    const BlendKernel start = best;
    for (const double f : {0.35, 0.6, 1.6, 2.8}) {
      BlendKernel k = best;
      k.shape_scale = start.shape_scale * f;
      attempt(k);
    }
    for (const double f : {0.5, 2.0}) {
      BlendKernel k = best;
      k.position_scale = start.position_scale * f;
      attempt(k);
    }
    for (const double share : {0.05, 0.2, 0.5}) {
      BlendKernel k = best;
      k.position_share = share;
      attempt(k);
    }
    for (const double noise : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
      BlendKernel k = best;
      k.noise = noise;
      attempt(k);
    }
  }
  kernel_ = best;
  fit(kernel_);
}

CurveBlend::Curve CurveBlend::at(const Eigen::VectorXd& shape, const Eigen::Vector3d& position,
                                 const Eigen::VectorXd& guess) const {
  const Eigen::Index n = sites_.shape.rows();
  const Eigen::VectorXd z = scaled_shape(shape);
  Eigen::VectorXd k(n);
  for (Eigen::Index i = 0; i < n; ++i)
    k[i] = covariance_of((sites_.shape.row(i).transpose() - z).norm(),
                         (sites_.position.row(i).transpose() - position).norm(), kernel_);
  const Eigen::VectorXd standard = (shape - mean_).cwiseProduct(inverse_deviation_);
  Eigen::RowVectorXd y = trend_.row(0) + standard.transpose() * trend_.bottomRows(standard.size()) +
                         k.transpose() * alpha_;
  if (guess.size() > 0) y += to_logarithms(guess.transpose());
  const Eigen::VectorXd v = factor_.matrixL().solve(k);
  const double variance = std::max(1 + kernel_.noise - v.squaredNorm(), 0.0);
  Curve out{to_travel(y).transpose(), {}, calibration_ * std::sqrt(variance)};
  if (others_.size() > 0) out.others = others_mean_ + k.transpose() * others_alpha_;
  return out;
}

}  // namespace palpate::stiffness
