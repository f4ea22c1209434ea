// SPDX-License-Identifier: GPL-3.0-or-later
// 7 and 12 unknowns of the head, and 3 of the jaw beside them. The jaw comes along from the first
// step: an affine map that has to reach an open jaw's chin stretches the whole skull.
#include "skull/coarse_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace palpate::skull {
namespace {

/// [rad] and [-]: largest turn and change of scale in one step of the similarity stage.
constexpr double kMostTurn = 0.15;
constexpr double kMostScale = 0.08;
/// [rad] and [mm]: largest change of the jaw's pose in one step.
const Vec3 kMostPose(0.15, 4, 4);

/// [mm] between people, of the lower face's height in closed bite. On skin (sn to me) 3.6 and 4.8
/// mm within men and women of one sample; the more, the more of an open mouth is taken for a long
/// face.
constexpr double kHeightSd = 4.5;

/// The points under the pose, in the template's frame and in the head's.
struct Places {
  std::vector<JawMotion> motion;
  std::vector<Vec3> head;
};
Places places_of(const FitProblem& p, const CoarseFit& fit) {
  Places places;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    places.motion.push_back(move_jaw(p.jaw, fit.pose, p.points[i].rest, p.weight[i]));
    places.head.push_back(fit.linear * places.motion[i].position + fit.translation);
  }
  return places;
}

std::vector<Vec3> normals_of(const FitProblem& p, const CoarseFit& fit, const Places& places) {
  std::vector<Vec3> n;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Mat3 gradient = fit.linear * (places.motion[i].turn +
                                        places.motion[i].by_weight *
                                            p.jaw.weight_gradient(p.points[i].rest).transpose());
    n.push_back((gradient.inverse().transpose() * p.points[i].normal).stableNormalized());
  }
  return n;
}

/// Solves for N - 3 unknowns and the pose, which come last. `jacobian` gives a row's first part.
template <int N, typename Jacobian>
Eigen::Matrix<double, N, 1> gauss_newton_step(const FitProblem& p, const CoarseFit& fit,
                                              const Places& places, const Linearisation& lin,
                                              Jacobian jacobian,
                                              Eigen::Matrix<double, N, N> hessian,
                                              Eigen::Matrix<double, N, 1> rhs) {
  const Vec3 precision = p.prior.precision();
  hessian.diagonal().template tail<3>() += precision;
  rhs.template tail<3>() -= precision.cwiseProduct(fit.pose.vector());
  for (const Row& row : lin.rows) {
    Eigen::Matrix<double, N, 1> j;
    j << jacobian(row),
        places.motion[row.point].by_pose.transpose() * (fit.linear.transpose() * row.direction);
    hessian += row.weight * j * j.transpose();
    rhs += row.weight * row.residual * j;
  }
  if (opening_is_held(fit.pose, rhs[N - 3])) {
    hessian.row(N - 3).setZero();
    hessian.col(N - 3).setZero();
    hessian(N - 3, N - 3) = 1;
    rhs[N - 3] = 0;
  }
  hessian.diagonal() *= 1 + 1e-9;
  Eigen::Matrix<double, N, 1> step = hessian.ldlt().solve(rhs);
  step.template tail<3>() = step.template tail<3>().cwiseMin(kMostPose).cwiseMax(-kMostPose);
  return step;
}

/// Steps until no point moves further than the tolerance. `advance` takes one.
template <typename Advance>
void iterate(const FitProblem& p, CoarseFit& fit, Advance advance) {
  Places at = places_of(p, fit);
  for (int it = 1; it <= p.options.depth.max_iterations; ++it) {
    const Standing now = standing(p.points, at.head, normals_of(p, fit, at), p.skin, p.options);
    advance(at, linearise(p.points, at.head, now, p.skin, p.options));
    ++fit.iterations;
    Places moved = places_of(p, fit);
    const double motion = largest_motion(at.head, moved.head);
    at = std::move(moved);
    if (motion < p.options.depth.step_tolerance) return;
  }
}

void solve_similarity(const FitProblem& p, CoarseFit& fit) {
  using V7 = Eigen::Matrix<double, 7, 1>;
  using V10 = Eigen::Matrix<double, 10, 1>;
  iterate(p, fit, [&](const Places& at, const Linearisation& lin) {
    const Vec3 center = bounding_box(at.head).center();
    const V10 step = gauss_newton_step<10>(
        p, fit, at, lin,
        [&](const Row& row) {
          const Vec3 arm = at.head[row.point] - center;
          V7 j;
          j << row.direction, arm.cross(row.direction), arm.dot(row.direction);
          return j;
        },
        Eigen::Matrix<double, 10, 10>::Zero(), V10::Zero());
    const Vec3 turn = step.segment<3>(3);
    const double angle = std::min(turn.norm(), kMostTurn);
    const Mat3 rotation = Eigen::AngleAxisd(angle, turn.stableNormalized()).toRotationMatrix();
    const Mat3 change = (1 + std::clamp(step[6], -kMostScale, kMostScale)) * rotation;
    fit.translation = change * (fit.translation - center) + center + step.head<3>();
    fit.linear = change * fit.linear;
    fit.pose = stepped(fit.pose, step.tail<3>());
  });
}

/// Prior on G in linear = similarity * (I + G): differences of the three scales and shears are
/// rare. Returns the rows of the quadratic form's factor.
Eigen::Matrix<double, 6, 9> strain_prior(const DepthFitOptions& o) {
  Eigen::Matrix<double, 6, 9> rows = Eigen::Matrix<double, 6, 9>::Zero();
  const auto at = [](int a, int b) { return 3 * a + b; };
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) rows(a, at(b, b)) = ((a == b) - 1.0 / 3) / o.strain_sd;
  int r = 3;
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b, ++r) rows(r, at(a, b)) = rows(r, at(b, a)) = 0.5 / o.shear_sd;
  return rows;
}

void solve_affine(const FitProblem& p, CoarseFit& fit) {
  using V9 = Eigen::Matrix<double, 9, 1>;
  using V12 = Eigen::Matrix<double, 12, 1>;
  using V15 = Eigen::Matrix<double, 15, 1>;
  using M15 = Eigen::Matrix<double, 15, 15>;
  const Mat3 similarity = fit.linear;
  V9 strain = V9::Zero();  // row by row
  const Eigen::Matrix<double, 6, 9> prior = strain_prior(p.options.depth);
  iterate(p, fit, [&](const Places& at, const Linearisation& lin) {
    M15 hessian = M15::Zero();
    V15 rhs = V15::Zero();
    hessian.block<9, 9>(3, 3) = prior.transpose() * prior;
    rhs.segment<9>(3) = -prior.transpose() * (prior * strain);
    const Vec3& span = p.height.span;
    const Vec3 way = similarity.transpose() * (fit.linear * span).stableNormalized();
    const double lacks = p.height.wanted(fit.scale) - p.height.way(fit.linear).dot(span);
    V9 stretch;
    stretch << way[0] * span, way[1] * span, way[2] * span;
    hessian.block<9, 9>(3, 3) += p.height.precision * stretch * stretch.transpose();
    rhs.segment<9>(3) += p.height.precision * lacks * stretch;
    const V15 step = gauss_newton_step<15>(
        p, fit, at, lin,
        [&](const Row& row) {
          const Vec3 d = similarity.transpose() * row.direction;
          const Vec3& place = at.motion[row.point].position;
          V12 j;
          j << row.direction, d[0] * place, d[1] * place, d[2] * place;
          return j;
        },
        hessian, rhs);
    strain += step.segment<9>(3);
    fit.translation += step.head<3>();
    fit.linear = similarity *
                 (Mat3::Identity() +
                  Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(strain.data()));
    fit.pose = stepped(fit.pose, step.tail<3>());
  });
}

}  // namespace

FaceHeight find_face_height(const SkullTemplate& skull, const Jaw& jaw) {
  const auto upper = skull.landmarks.find("ss"), lower = skull.landmarks.find("me");
  if (!jaw.present || upper == skull.landmarks.end() || lower == skull.landmarks.end()) return {};
  FaceHeight height;
  height.upper = upper->second.position;
  height.lower = lower->second.position;
  height.span = height.upper - height.lower;
  height.precision = 1 / (kHeightSd * kHeightSd);
  return height;
}

CoarseFit solve_coarse(const FitProblem& problem, const registration::Placement& start,
                       double opening) {
  CoarseFit fit{start.linear, start.translation, {opening, 0, 0}, 1, 0};
  solve_similarity(problem, fit);
  fit.scale = std::cbrt(fit.linear.determinant());
  solve_affine(problem, fit);
  return fit;
}

double largest_motion(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

JawPose stepped(const JawPose& pose, const Vec3& step) {
  JawPose next = JawPose::from(pose.vector() + step);
  next.opening = std::clamp(next.opening, 0.0, kWidestOpening);
  return next;
}

bool opening_is_held(const JawPose& pose, double pull) {
  return (pose.opening <= 0 && pull < 0) || (pose.opening >= kWidestOpening && pull > 0);
}

}  // namespace palpate::skull
