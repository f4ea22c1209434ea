// SPDX-License-Identifier: GPL-3.0-or-later
// f(x) = A x + b + sum_i w_i exp(-|x - x_i|^2 / 2 h^2). The affine part is the similarity of the
// landmarks (Umeyama 1991) plus as much of a general linear map as they support: the face's
// landmarks lie nearly on a sheet and say little about depth, so the difference is damped (ridge).
// The bumps take up what remains, with the ridge of a smoother (Gaussian process regression).
#include "landmarks/face_warp.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/error.hpp"
#include "landmarks/face_model.hpp"

namespace palpate::landmarks {
namespace {

constexpr double kReach = 35;        // [mm] h, about the distance between neighbouring landmarks
constexpr double kSmoothing = 0.5;   // [-] a lone landmark 3 mm off moves its place by 2 mm
constexpr double kCertain = 0.3;     // [-] below this confidence a landmark is a guess: left out
constexpr double kAffineHold = 2e4;  // [mm^2] pull of the linear part towards the similarity

double bump(const Vec3& r) {
  return std::exp(-r.squaredNorm() / (2 * kReach * kReach));
}

// Every landmark of the model that the head has; a side is used only together with the other one,
// so that the map of a symmetric head is symmetric.
std::vector<std::string> usable(const LandmarkSet& landmarks) {
  const auto has = [&](const std::string& name) {
    const auto at = landmarks.find(name);
    return at != landmarks.end() && at->second.confidence >= kCertain;
  };
  const auto other_side = [](std::string name) {
    const auto left = name.rfind("_left"), right = name.rfind("_right");
    if (left != std::string::npos) return name.replace(left, 5, "_right");
    if (right != std::string::npos) return name.replace(right, 6, "_left");
    return name;
  };
  std::vector<std::string> names;
  for (const auto& [name, unused] : face_model().marks) {
    if (has(name) && has(other_side(name))) names.push_back(name);
  }
  return names;
}

}  // namespace

FaceWarp::FaceWarp(const LandmarkSet& landmarks) {
  for (const char* name : {"nose_tip", "eye_outer_left", "eye_outer_right"}) {
    if (!landmarks.contains(name)) {
      throw InputError(fmt::format("landmark {} is missing; the regions need it", name));
    }
  }
  std::vector<std::string> names = usable(landmarks);
  if (names.size() < 3) names = {"eye_outer_left", "eye_outer_right", "nose_tip"};
  const int n = static_cast<int>(names.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (int i = 0; i < n; ++i) {
    from.col(i) = landmarks.at(names[i]).position;
    to.col(i) = face_model().marks.at(names[i]);
  }
  // The similarity first, then what of a linear map the points support beyond it.
  const Eigen::Matrix4d similarity = Eigen::umeyama(from, to, true);
  const Mat3 s = similarity.topLeftCorner<3, 3>();
  const Vec3 from_middle = from.rowwise().mean(), to_middle = to.rowwise().mean();
  const Eigen::Matrix3Xd x = from.colwise() - from_middle, y = to.colwise() - to_middle;
  const Mat3 gram = x * x.transpose() + kAffineHold * Mat3::Identity();
  linear_ = s + ((y - s * x) * x.transpose()) * gram.inverse();
  offset_ = to_middle - linear_ * from_middle;

  Eigen::MatrixXd kernel(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) kernel(i, j) = bump(from.col(i) - from.col(j));
  }
  kernel.diagonal().array() += kSmoothing;
  const Eigen::Matrix3Xd rest = y - linear_ * x;
  const Eigen::MatrixX3d weights = kernel.ldlt().solve(Eigen::MatrixX3d(rest.transpose()));
  for (int i = 0; i < n; ++i) {
    centers_.push_back(from.col(i));
    weights_.push_back(weights.row(i).transpose());
  }
}

Vec3 FaceWarp::to_mean(const Vec3& head) const {
  Vec3 p = linear_ * head + offset_;
  for (std::size_t i = 0; i < centers_.size(); ++i) p += weights_[i] * bump(head - centers_[i]);
  return p;
}

}  // namespace palpate::landmarks
