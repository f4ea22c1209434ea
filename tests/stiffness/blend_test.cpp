// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/blend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate::stiffness {
namespace {

/// A curve that depends on the inputs as tissue does: stiffening, softer where it is deep.
Eigen::RowVectorXd curve(const Eigen::RowVectorXd& shape) {
  Eigen::RowVectorXd u(4);
  for (int i = 0; i < 4; ++i)
    u[i] = std::exp(0.6 * shape[0] + 0.1 * shape[1] * shape[1]) * std::pow(1.0 + i, 0.6) *
           (1 + 0.05 * i * std::tanh(shape[0]));
  return u;
}

struct Samples {
  BlendInputs inputs;
  Eigen::MatrixXd travel;
};
Samples samples(int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> d(-1, 1);
  Samples s{{Eigen::MatrixXd(n, 3), Eigen::MatrixXd(n, 3), {}}, Eigen::MatrixXd(n, 4)};
  for (double& v : s.inputs.shape.reshaped()) v = d(random);
  for (double& v : s.inputs.position.reshaped()) v = 10 * d(random);
  for (int i = 0; i < n; ++i) s.travel.row(i) = curve(s.inputs.shape.row(i));
  return s;
}

TEST(CurveBlend, LearnsASmoothFamilyAndKnowsHowWell) {
  const Samples train = samples(150, 1), test = samples(200, 2);
  const CurveBlend blend(train.inputs, train.travel);
  double sum = 0, predicted = 0;
  for (int i = 0; i < 200; ++i) {
    const auto c = blend.at(test.inputs.shape.row(i), test.inputs.position.row(i).transpose());
    const Eigen::VectorXd error =
        (c.travel.transpose() - test.travel.row(i)).cwiseQuotient(test.travel.row(i)).transpose();
    sum += error.squaredNorm() / 4;
    predicted += c.error * c.error;
    for (int l = 1; l < 4; ++l) EXPECT_GT(c.travel[l], c.travel[l - 1]);
  }
  const double actual = std::sqrt(sum / 200);
  EXPECT_LT(actual, 0.02);
  EXPECT_LT(std::abs(std::log(std::sqrt(predicted / 200) / actual)), std::log(4.0));
}

TEST(CurveBlend, ReproducesItsSites) {
  const Samples train = samples(80, 5);
  const CurveBlend blend(train.inputs, train.travel);
  for (int i = 0; i < 80; ++i) {
    const auto c = blend.at(train.inputs.shape.row(i), train.inputs.position.row(i).transpose());
    EXPECT_LT((c.travel.transpose() - train.travel.row(i)).norm(),
              0.02 * train.travel.row(i).norm());
  }
}

TEST(CurveBlend, DoubtsWhatIsFarFromItsSites) {
  const Samples train = samples(100, 6);
  const CurveBlend blend(train.inputs, train.travel);
  const double near = blend.at(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).error;
  const double far = blend.at(Eigen::Vector3d(6, -6, 6), Eigen::Vector3d(90, 0, 0)).error;
  EXPECT_GT(far, 3 * near);
}

}  // namespace
}  // namespace palpate::stiffness
