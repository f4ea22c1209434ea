// SPDX-License-Identifier: GPL-3.0-or-later
// Three nested families of maps, each started from the last: 7, 12 and about 1500 unknowns. Depth
// is a distance, so its gradient is known exactly and Gauss-Newton converges in some ten steps. The
// spline works in the template's frame, where the mirror plane is x = 0.
#include "skull/depth_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"

namespace palpate::skull {
namespace {

/// [rad] and [-]: largest turn and change of scale in one step of the similarity stage.
constexpr double kMostTurn = 0.15;
constexpr double kMostScale = 0.08;
/// [mm] largest motion of a point in one step of the spline stage: the linearisation's reach.
constexpr double kMostMotion = 8;
constexpr int kHalvings = 8;
/// [-] of the mean diagonal: control points that no bone reaches stay determined.
constexpr double kDamping = 1e-8;
constexpr double kStiffer = 3;  ///< [-] per retry where the map came close to folding
constexpr int kRetries = 4;

struct Problem {
  const SkullTemplate& skull;
  const std::vector<FitPoint>& points;
  const SkinField& skin;
  const FitOptions& options;
};

std::vector<Vec3> positions_of(const Problem& p, const Mat3& linear, const Vec3& translation) {
  std::vector<Vec3> x;
  for (const FitPoint& point : p.points) x.push_back(linear * point.rest + translation);
  return x;
}

std::vector<Vec3> normals_of(const Problem& p, const Mat3& linear) {
  const Mat3 cofactor = linear.inverse().transpose();
  std::vector<Vec3> n;
  for (const FitPoint& point : p.points) n.push_back((cofactor * point.normal).stableNormalized());
  return n;
}

double largest_motion(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

template <int N, typename Jacobian>
Eigen::Matrix<double, N, 1> gauss_newton_step(const Linearisation& lin, Jacobian jacobian,
                                              Eigen::Matrix<double, N, N> hessian,
                                              Eigen::Matrix<double, N, 1> rhs) {
  for (const Row& row : lin.rows) {
    const Eigen::Matrix<double, N, 1> j = jacobian(row);
    hessian += row.weight * j * j.transpose();
    rhs += row.weight * row.residual * j;
  }
  hessian.diagonal() *= 1 + 1e-9;
  return hessian.ldlt().solve(rhs);
}

/// Returns the number of steps.
int solve_similarity(const Problem& p, Mat3& linear, Vec3& translation) {
  std::vector<Vec3> x = positions_of(p, linear, translation);
  for (int it = 1; it <= p.options.depth.max_iterations; ++it) {
    const Standing now = standing(p.points, x, normals_of(p, linear), p.skin, p.options);
    const Linearisation lin = linearise(p.points, x, now, p.skin, p.options);
    const Vec3 center = bounding_box(x).center();
    using V7 = Eigen::Matrix<double, 7, 1>;
    const V7 step = gauss_newton_step<7>(
        lin,
        [&](const Row& row) {
          const Vec3 arm = x[row.point] - center;
          V7 j;
          j << row.direction, arm.cross(row.direction), arm.dot(row.direction);
          return j;
        },
        Eigen::Matrix<double, 7, 7>::Zero(), V7::Zero());
    const Vec3 turn = step.segment<3>(3);
    const double angle = std::min(turn.norm(), kMostTurn);
    const Mat3 rotation = Eigen::AngleAxisd(angle, turn.stableNormalized()).toRotationMatrix();
    const Mat3 change = (1 + std::clamp(step[6], -kMostScale, kMostScale)) * rotation;
    translation = change * (translation - center) + center + step.head<3>();
    linear = change * linear;
    const std::vector<Vec3> moved = positions_of(p, linear, translation);
    const double motion = largest_motion(x, moved);
    x = moved;
    if (motion < p.options.depth.step_tolerance) return it;
  }
  return p.options.depth.max_iterations;
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

int solve_affine(const Problem& p, Mat3& linear, Vec3& translation) {
  const Mat3 similarity = linear;
  Mat3 strain = Mat3::Zero();
  const Eigen::Matrix<double, 6, 9> prior = strain_prior(p.options.depth);
  std::vector<Vec3> x = positions_of(p, linear, translation);
  using V12 = Eigen::Matrix<double, 12, 1>;
  using M12 = Eigen::Matrix<double, 12, 12>;
  for (int it = 1; it <= p.options.depth.max_iterations; ++it) {
    const Standing now = standing(p.points, x, normals_of(p, linear), p.skin, p.options);
    const Linearisation lin = linearise(p.points, x, now, p.skin, p.options);
    Eigen::Matrix<double, 9, 1> current;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) current[3 * a + b] = strain(a, b);
    M12 hessian = M12::Zero();
    V12 rhs = V12::Zero();
    hessian.bottomRightCorner<9, 9>() = prior.transpose() * prior;
    rhs.tail<9>() = -prior.transpose() * (prior * current);
    const V12 step = gauss_newton_step<12>(
        lin,
        [&](const Row& row) {
          const Vec3 d = similarity.transpose() * row.direction;
          const Vec3& rest = p.points[row.point].rest;
          V12 j;
          j << row.direction, d[0] * rest, d[1] * rest, d[2] * rest;
          return j;
        },
        hessian, rhs);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) strain(a, b) += step[3 + 3 * a + b];
    translation += step.head<3>();
    linear = similarity * (Mat3::Identity() + strain);
    const std::vector<Vec3> moved = positions_of(p, linear, translation);
    const double motion = largest_motion(x, moved);
    x = moved;
    if (motion < p.options.depth.step_tolerance) return it;
  }
  return p.options.depth.max_iterations;
}

/// The spline stage's fixed data: shares of every point.
struct SplineSystem {
  std::vector<SplineWeights> weights;
  std::vector<std::vector<std::int32_t>> by_cell;  // points that share their 64 control points
  Eigen::MatrixXd stiffness;
};

SplineSystem make_system(const Problem& p, const SkullMap& map) {
  SplineSystem s;
  std::map<std::int32_t, std::vector<std::int32_t>> cells;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    s.weights.push_back(map.lattice.weights(p.points[i].rest));
    cells[s.weights[i].control[0]].push_back(static_cast<std::int32_t>(i));
  }
  for (auto& [first, members] : cells) s.by_cell.push_back(std::move(members));
  s.stiffness = spline_stiffness(map.lattice, p.options.depth);
  return s;
}

std::vector<Vec3> positions_of(const Problem& p, const SplineSystem& s, const SkullMap& map) {
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    Vec3 u = Vec3::Zero();
    for (int c = 0; c < 64; ++c)
      u += s.weights[i].share[c] * map.control.row(s.weights[i].control[c]).transpose();
    x.push_back(map.linear * (p.points[i].rest + u) + map.translation);
  }
  return x;
}

std::vector<Vec3> normals_of(const Problem& p, const SkullMap& map) {
  std::vector<Vec3> n;
  for (const FitPoint& point : p.points)
    n.push_back((map.gradient(point.rest).inverse().transpose() * point.normal).stableNormalized());
  return n;
}

double stiffness_energy(const SplineSystem& s, const Eigen::MatrixX3d& control) {
  const Eigen::Map<const Eigen::VectorXd> u(control.data(), control.size());
  return 0.5 * u.dot(s.stiffness * u);
}

/// What the points of one lattice cell ask of its 64 control points.
struct CellRows {
  Eigen::MatrixXd hessian;  // 192 x 192; empty where nothing is asked
  Eigen::VectorXd pull;
};

CellRows cell_rows(const SplineSystem& s, const SkullMap& map,
                   const std::vector<const Row*>& rows) {
  if (rows.empty()) return {};
  Eigen::MatrixXd jacobian(192, rows.size());
  Eigen::VectorXd weight(rows.size()), pull(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Vec3 d = map.linear.transpose() * rows[r]->direction;
    const SplineWeights& w = s.weights[rows[r]->point];
    for (int a = 0; a < 3; ++a)
      for (int c = 0; c < 64; ++c) jacobian(64 * a + c, r) = w.share[c] * d[a];
    weight[r] = rows[r]->weight;
    pull[r] = rows[r]->weight * rows[r]->residual;
  }
  return {jacobian * weight.asDiagonal() * jacobian.transpose(), jacobian * pull};
}

/// Adds the rows' normal equations, cell by cell: the points of a cell share their control points.
void add_rows(const Problem& p, const SplineSystem& s, const SkullMap& map,
              const Linearisation& lin, Eigen::MatrixXd& hessian, Eigen::VectorXd& rhs) {
  std::vector<std::vector<const Row*>> rows_of(p.points.size());
  for (const Row& row : lin.rows) rows_of[row.point].push_back(&row);
  std::vector<CellRows> cells(s.by_cell.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t k) {
    std::vector<const Row*> rows;
    for (const std::int32_t i : s.by_cell[k])
      rows.insert(rows.end(), rows_of[i].begin(), rows_of[i].end());
    cells[k] = cell_rows(s, map, rows);
  });
  const int n = map.lattice.size();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k].pull.size() == 0) continue;
    const SplineWeights& w = s.weights[s.by_cell[k].front()];
    for (int q = 0; q < 192; ++q) {
      const int col = q / 64 * n + w.control[q % 64];
      rhs[col] += cells[k].pull[q];
      for (int r = 0; r < 192; ++r)
        hessian(r / 64 * n + w.control[r % 64], col) += cells[k].hessian(r, q);
    }
  }
}

int solve_spline(const Problem& p, SkullMap& map, double& energy, const Progress& progress) {
  const SplineSystem s = make_system(p, map);
  const int n = map.lattice.size();
  std::vector<Vec3> x = positions_of(p, s, map);
  int it = 0;
  for (it = 1; it <= p.options.depth.max_iterations; ++it) {
    progress.step("fit", 0.2 + 0.6 * it / p.options.depth.max_iterations);
    const Standing now = standing(p.points, x, normals_of(p, map), p.skin, p.options);
    const Linearisation lin = linearise(p.points, x, now, p.skin, p.options);
    Eigen::MatrixXd hessian = s.stiffness;
    Eigen::Map<const Eigen::VectorXd> u(map.control.data(), map.control.size());
    Eigen::VectorXd rhs = -(s.stiffness * u);
    add_rows(p, s, map, lin, hessian, rhs);
    hessian.diagonal().array() += kDamping * hessian.trace() / (3 * n);
    const Eigen::VectorXd step = hessian.llt().solve(rhs);
    const Eigen::MatrixX3d change = Eigen::Map<const Eigen::MatrixX3d>(step.data(), n, 3);

    const double before = lin.energy + stiffness_energy(s, map.control);
    SkullMap trial = map;
    trial.control = map.control + change;
    double share = std::min(1.0, kMostMotion / largest_motion(x, positions_of(p, s, trial)));
    std::vector<Vec3> moved;
    for (int half = 0; half <= kHalvings; ++half, share *= 0.5) {
      trial.control = map.control + share * change;
      moved = positions_of(p, s, trial);
      energy = linearise(p.points, moved, now, p.skin, p.options).energy +
               stiffness_energy(s, trial.control);
      if (energy < before) break;
    }
    if (!(energy < before)) {
      energy = before;
      break;
    }
    const double motion = largest_motion(x, moved);
    map.control = trial.control;
    x = std::move(moved);
    if (motion < p.options.depth.step_tolerance) break;
  }
  return std::min(it, p.options.depth.max_iterations);
}

/// Hessian of the energy where the spline stage ended.
Eigen::MatrixXd information_at(const Problem& p, const SkullMap& map) {
  const SplineSystem s = make_system(p, map);
  const std::vector<Vec3> x = positions_of(p, s, map);
  const Standing now = standing(p.points, x, normals_of(p, map), p.skin, p.options);
  Eigen::MatrixXd hessian = s.stiffness;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(hessian.rows());
  add_rows(p, s, map, linearise(p.points, x, now, p.skin, p.options), hessian, rhs);
  hessian.diagonal().array() += kDamping * hessian.trace() / static_cast<double>(hessian.rows());
  return hessian;
}

double least_jacobian(const SkullTemplate& skull, const SkullMap& map) {
  const double rest = map.linear.determinant();
  double least = 1e300;
  for (const Vec3& v : skull.mesh.points)
    least = std::min(least, map.gradient(v).determinant() / rest);
  return least;
}

Box lattice_box(const SkullTemplate& skull) {
  std::vector<Vec3> all = skull.mesh.points;
  for (const auto& [name, p] : skull.registration_points) all.push_back(p);
  return bounding_box(all);
}

}  // namespace

Vec3 SkullMap::operator()(const Vec3& x) const {
  const SplineWeights w = lattice.weights(x);
  Vec3 u = Vec3::Zero();
  for (int c = 0; c < 64; ++c) u += w.share[c] * control.row(w.control[c]).transpose();
  return linear * (x + u) + translation;
}

Mat3 SkullMap::gradient(const Vec3& x) const {
  const SplineWeights w = lattice.weights(x);
  const Eigen::Matrix<double, 64, 3> g = lattice.gradients(x);
  Mat3 inner = Mat3::Identity();
  for (int c = 0; c < 64; ++c) inner += control.row(w.control[c]).transpose() * g.row(c);
  return linear * inner;
}

Eigen::MatrixXd spline_stiffness(const SplineLattice& lattice, const DepthFitOptions& options) {
  const int n = lattice.size();
  const Eigen::MatrixXd k = options.bending * lattice.bending();
  const std::vector<std::int32_t> mirror = lattice.mirror();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  // The asymmetric part of u is (u - M u)/2, M mirroring places and turning x. K commutes with M,
  // so its energy is u^T K (I - M)/2 u.
  for (int a = 0; a < 3; ++a) {
    const double sign = a == 0 ? -1 : 1;
    for (int col = 0; col < n; ++col)
      for (int row = 0; row < n; ++row)
        whole(a * n + row, a * n + col) = (1 + 0.5 * options.asymmetry) * k(row, col) -
                                          0.5 * options.asymmetry * sign * k(row, mirror[col]);
  }
  return whole;
}

DepthFit solve_depth_fit(const SkullTemplate& skull, const std::vector<FitPoint>& points,
                         const SkinField& skin, const registration::Placement& start,
                         const FitOptions& options, const Progress& progress) {
  const Problem problem{skull, points, skin, options};
  DepthFit fit{{start.linear,
                start.translation,
                SplineLattice(lattice_box(skull), options.depth.spacing),
                {}}};
  progress.step("fit", 0.05);
  fit.iterations += solve_similarity(problem, fit.map.linear, fit.map.translation);
  progress.step("fit", 0.1);
  fit.iterations += solve_affine(problem, fit.map.linear, fit.map.translation);

  FitOptions stiffer = options;
  for (int retry = 0; retry <= kRetries; ++retry) {
    fit.map.control = Eigen::MatrixX3d::Zero(fit.map.lattice.size(), 3);
    const Problem again{skull, points, skin, stiffer};
    fit.iterations += solve_spline(again, fit.map, fit.energy, progress);
    fit.bending_used = stiffer.depth.bending;
    fit.least_jacobian = least_jacobian(skull, fit.map);
    if (fit.least_jacobian >= options.depth.least_jacobian) {
      fit.information = information_at(again, fit.map);
      return fit;
    }
    stiffer.depth.bending *= kStiffer;
  }
  throw SolveError("the skull could not be fitted without folding: check the landmarks",
                   fit.least_jacobian, fit.iterations);
}

}  // namespace palpate::skull
