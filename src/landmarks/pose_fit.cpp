// SPDX-License-Identifier: GPL-3.0-or-later
// Besl & McKay 1992 (iterated closest points), Chen & Medioni 1992 (point to plane), with the modes
// of a statistical shape as further unknowns (Amberg et al. 2008).
//
// Unknowns of one step: w (rotation about the model's centroid), v (translation), g (log scale) and
// the change of the coefficients c. A model point q near the surface point s with normal n moves by
//   dq = w x (q - o) + v + g (q - o) + scale R sum_k B_k dc_k
// and r = n . (q + dq - s) is minimised with weights, plus sideways^2 |q + dq - s|^2 (which keeps a
// smooth surface from sliding) and the prior |c|^2 of the population.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "landmarks/pose.hpp"

namespace palpate::landmarks {
namespace {

constexpr int kUnknowns = 7 + FaceModel::kModes;
using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Vector = Eigen::Matrix<double, kUnknowns, 1>;
using Rows = Eigen::Matrix<double, 3, kUnknowns>;

constexpr double kSideways = 0.3;  // [-] weight of sliding against leaving the surface
constexpr double kPrior = 12;      // [mm^2 per SD^2]: 0.4 mm rms over the about 300 points
constexpr int kMouthUnknown = 7 + FaceModel::kOpening;
constexpr double kWidestMouth = 1.7;    // [-] 33 degrees (Ferrario et al. 2005)
constexpr double kScalePrior = 4000;    // [mm^2]: a size 10 % off the mean costs 40 mm^2
constexpr double kPinWeight = 60;       // [-] a user's point counts as much as 60 surface points
constexpr double kLikeDirection = 0.2;  // [-] cosine below which a point faces elsewhere

Matrix system_diagonal(const FitSchedule& schedule) {
  Matrix a = Matrix::Zero();
  a.diagonal().setConstant(1e-6);
  a(6, 6) = schedule.with_scale ? kScalePrior : 1e12;
  for (int k = 7; k < kUnknowns; ++k) a(k, k) = schedule.with_shape ? kPrior : 1e12;
  if (!schedule.with_mouth) a(kMouthUnknown, kMouthUnknown) = 1e12;
  return a;
}

struct Match {
  Vec3 q, s, n;
  double weight;
};

Match match(const Skin& skin, const FacePose& pose, std::size_t i, double tolerance, double reach,
            std::vector<surface::PointTree::Neighbour>& found) {
  const FaceModel& model = face_model();
  Match m;
  m.q = pose.to_scan(model.point(i, pose.shape));
  skin.tree.nearest(m.q, 1, found);
  m.s = skin.mesh.points[found[0].point];
  m.n = skin.normals[found[0].point];
  const double like = m.n.dot(pose.rotation * model.normals[i]);
  const double r = m.n.dot(m.q - m.s) / tolerance;
  const double drop = 1 / (1 + r * r);
  const bool far = found[0].distance2 > reach * reach;
  m.weight = like < kLikeDirection || far ? 0 : drop * drop;
  return m;
}

// d(point)/d(unknowns) of the model point at `q` whose modes are `modes`.
Rows derivative(const FacePose& pose, const Vec3& q, const FaceModel::Modes& modes,
                const Vec3& origin) {
  Rows rows;
  const Vec3 arm = q - origin;
  rows.leftCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  rows.middleCols<3>(3).setIdentity();
  rows.col(6) = arm;
  for (int k = 0; k < FaceModel::kModes; ++k) {
    rows.col(7 + k) = pose.scale * (pose.rotation * modes[k]);
  }
  return rows;
}

void add_pins(const FacePose& pose, const Pins& pins, const Vec3& origin, Matrix& a, Vector& b) {
  const FaceModel& model = face_model();
  for (const auto& [name, target] : pins) {
    if (!model.marks.contains(name)) continue;
    const Vec3 q = pose.to_scan(model.mark(name, pose.shape));
    const Rows rows = derivative(pose, q, model.mark_modes.at(name), origin);
    a.noalias() += kPinWeight * rows.transpose() * rows;
    b.noalias() -= kPinWeight * rows.transpose() * (q - target);
  }
}

void apply(FacePose& pose, const Vector& step, const Vec3& origin) {
  const Vec3 w = step.head<3>();
  const double angle = w.norm();
  const Mat3 turn =
      angle > 0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Mat3(Mat3::Identity());
  const double grow = std::exp(std::clamp(step[6], -0.1, 0.1));
  pose.translation =
      origin + Vec3(step.segment<3>(3)) + grow * (turn * (pose.translation - origin));
  pose.rotation = turn * pose.rotation;
  pose.scale *= grow;
  for (int k = 0; k < FaceModel::kModes; ++k) {
    pose.shape[k] = std::clamp(pose.shape[k] + step[7 + k], -3.0, 3.0);
  }
  pose.shape[FaceModel::kOpening] = std::clamp(pose.shape[FaceModel::kOpening], 0.0, kWidestMouth);
}

}  // namespace

FacePose fit_pose(const Skin& skin, FacePose pose, const FitSchedule& schedule, const Pins& pins) {
  const FaceModel& model = face_model();
  std::vector<surface::PointTree::Neighbour> found;
  for (int iteration = 0; iteration < schedule.iterations; ++iteration) {
    // Far outliers still pull in the first steps; the tolerance tightens to its final value.
    const double widen = std::max(1.0, 3.0 - iteration);
    Matrix a = system_diagonal(schedule);
    Vector b = Vector::Zero();
    b[6] = schedule.with_scale ? -kScalePrior * std::log(pose.scale) : 0;
    for (int k = 0; k < FaceModel::kModes && schedule.with_shape; ++k) {
      b[7 + k] = -kPrior * pose.shape[k];
    }
    const Vec3 origin = pose.to_scan(Vec3(0, -30, 0));
    for (std::size_t i = 0; i < model.points.size(); i += schedule.stride) {
      const Match m = match(skin, pose, i, widen * schedule.tolerance_mm, schedule.reach_mm, found);
      if (m.weight == 0) continue;
      const Rows rows = derivative(pose, m.q, model.modes[i], origin);
      const Mat3 metric =
          m.weight * (m.n * m.n.transpose() + kSideways * kSideways * Mat3::Identity());
      const Rows weighted = metric * rows;
      a.noalias() += rows.transpose() * weighted;
      b.noalias() -= weighted.transpose() * (m.q - m.s);
    }
    add_pins(pose, pins, origin, a, b);
    Vector step = a.ldlt().solve(b);
    if (!schedule.with_mouth)
      step[kMouthUnknown] = 0;  // not even by the rounding of a stiff spring
    apply(pose, step, origin);
  }
  return pose;
}

namespace {

struct Tally {
  PartFit part{0, 0, 0};
  int n = 0;
  void add(double distance, double like) {
    constexpr double kCap = 10, kOutlier = 6;  // [mm]
    const bool away = like < kLikeDirection;
    part.mean_distance += away ? kCap : std::min(distance, kCap);
    part.agreement += like;
    part.outliers += away || distance > kOutlier;
    ++n;
  }
  [[nodiscard]] PartFit mean() const {
    return {part.mean_distance / n, part.agreement / n, part.outliers / n};
  }
};

}  // namespace

double FaceFit::cost() const {
  return core.cost() + 0.5 * std::min(lower.cost(), 3.0) + 0.25 * std::min(vault.cost(), 4.0);
}

FaceFit judge(const Skin& skin, const FacePose& pose, int stride) {
  constexpr double kVault = 50, kMouth = -50, kSide = -20;  // [mm] borders in the model's frame
  const FaceModel& model = face_model();
  std::vector<surface::PointTree::Neighbour> found;
  Tally core, lower, vault;
  for (std::size_t i = 0; i < model.points.size(); i += stride) {
    const Vec3 q = pose.to_scan(model.point(i, pose.shape));
    skin.tree.nearest(q, 1, found);
    const Vec3& normal = skin.normals[found[0].point];
    const double like = normal.dot(pose.rotation * model.normals[i]);
    // Distance to the tangent plane, but never less than the full distance less a mesh edge, so
    // that the plane of a far point does not count as near.
    const double along = std::abs(normal.dot(q - skin.mesh.points[found[0].point]));
    const double distance = std::max(along, std::sqrt(found[0].distance2) - 3);
    const Vec3& m = model.points[i];
    Tally& part = m.y() > kVault || m.z() < kSide ? vault : m.y() < kMouth ? lower : core;
    part.add(distance, like);
  }
  return {core.mean(), lower.mean(), vault.mean()};
}

}  // namespace palpate::landmarks
