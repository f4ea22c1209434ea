// SPDX-License-Identifier: GPL-3.0-or-later
// Three nested families of maps, each started from the last: 7, 12 and about 1500 unknowns, and the
// jaw's 3. Depth is a distance, so its gradient is known exactly and Gauss-Newton converges in some
// ten steps. The spline works in the template's frame, where the mirror plane is x = 0.
// Whether the mouth is open is decided by fitting both ways: the prior of the pose is a mixture of
// a narrow Gaussian (closed) and a wide one, whose likelier part is taken.
#include "skull/depth_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "skull/coarse_fit.hpp"

namespace palpate::skull {
namespace {

/// [mm] largest motion of a point in one step of the spline stage: the linearisation's reach.
constexpr double kMostMotion = 8;
constexpr int kHalvings = 8;
/// [-] of the mean diagonal: control points that no bone reaches stay determined.
constexpr double kDamping = 1e-8;
constexpr double kStiffer = 3;  ///< [-] per retry where the map came close to folding
constexpr int kRetries = 4;
/// [rad] opening after the affine stage (4 degrees) below which an open mouth is not looked for.
constexpr double kSuspect = 0.07;
/// [-] of energy by which an open mouth must explain the skin better than a closed one: one scan in
/// twenty has one (3), and of what its wider prior may do the skin rules out most (2: the ratio of
/// the priors' volumes, 180, over that of what is left of them, some 28). Less takes long faces for
/// open mouths.
constexpr double kOpenMargin = 5;

/// The spline stage's fixed data: shares of every point.
struct SplineSystem {
  std::vector<SplineWeights> weights;
  std::vector<std::vector<std::int32_t>> by_cell;  // points that share their 64 control points
  Eigen::MatrixXd stiffness;
  Eigen::VectorXd height;  // [-] change of the lower face's height with the control points
  double wanted_height;    // [mm]
};

SplineSystem make_system(const FitProblem& p, const SkullMap& map, double scale) {
  SplineSystem s;
  std::map<std::int32_t, std::vector<std::int32_t>> cells;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    s.weights.push_back(map.lattice.weights(p.points[i].rest));
    cells[s.weights[i].control[0]].push_back(static_cast<std::int32_t>(i));
  }
  for (auto& [first, members] : cells) s.by_cell.push_back(std::move(members));
  s.stiffness = spline_stiffness(map.lattice, p.options.depth);
  const int n = map.lattice.size();
  const Vec3 way = p.height.way(map.linear);
  const SplineWeights up = map.lattice.weights(p.height.upper),
                      low = map.lattice.weights(p.height.lower);
  s.height = Eigen::VectorXd::Zero(3 * n);
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 64; ++c) {
      s.height[a * n + up.control[c]] += way[a] * up.share[c];
      s.height[a * n + low.control[c]] -= way[a] * low.share[c];
    }
  s.wanted_height = p.height.wanted(scale) - way.dot(p.height.span);
  return s;
}

std::vector<Vec3> positions_of(const FitProblem& p, const SplineSystem& s, const SkullMap& map) {
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const Vec3 shaped = map.shaped(p.points[i].rest, s.weights[i]);
    x.push_back(map.linear * move_jaw(map.jaw, map.pose, shaped, p.weight[i]).position +
                map.translation);
  }
  return x;
}

std::vector<Vec3> normals_of(const FitProblem& p, const SkullMap& map) {
  std::vector<Vec3> n;
  for (const FitPoint& point : p.points)
    n.push_back((map.gradient(point.rest).inverse().transpose() * point.normal).stableNormalized());
  return n;
}

/// Of bending, the face's height and the pose.
double prior_energy(const FitProblem& p, const SplineSystem& s, const SkullMap& map) {
  const Eigen::Map<const Eigen::VectorXd> u(map.control.data(), map.control.size());
  const double lacks = s.wanted_height - s.height.dot(u);
  return 0.5 * u.dot(s.stiffness * u) + 0.5 * p.height.precision * lacks * lacks +
         0.5 * map.pose.vector().cwiseAbs2().dot(p.prior.precision());
}

/// What the points of one lattice cell ask of its 64 control points and, last, of the pose.
struct CellRows {
  Eigen::MatrixXd hessian;  // 195 x 195; empty where nothing is asked
  Eigen::VectorXd pull;
};

CellRows cell_rows(const FitProblem& p, const SplineSystem& s, const SkullMap& map,
                   const std::vector<const Row*>& rows) {
  if (rows.empty()) return {};
  Eigen::MatrixXd jacobian(195, rows.size());
  Eigen::VectorXd weight(rows.size()), pull(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::int32_t point = rows[r]->point;
    const SplineWeights& w = s.weights[point];
    const JawMotion motion =
        move_jaw(map.jaw, map.pose, map.shaped(p.points[point].rest, w), p.weight[point]);
    const Vec3 way = map.linear.transpose() * rows[r]->direction, d = motion.turn.transpose() * way;
    for (int a = 0; a < 3; ++a)
      for (int c = 0; c < 64; ++c) jacobian(64 * a + c, r) = w.share[c] * d[a];
    jacobian.col(r).tail<3>() = motion.by_pose.transpose() * way;
    weight[r] = rows[r]->weight;
    pull[r] = rows[r]->weight * rows[r]->residual;
  }
  return {jacobian * weight.asDiagonal() * jacobian.transpose(), jacobian * pull};
}

/// The energy's second derivatives (Gauss-Newton) and minus its slope.
struct NormalEquations {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd pull;
};

/// Priors and rows, cell by cell: the points of a cell share their control points.
NormalEquations normal_equations(const FitProblem& p, const SplineSystem& s, const SkullMap& map,
                                 const Linearisation& lin) {
  std::vector<std::vector<const Row*>> rows_of(p.points.size());
  for (const Row& row : lin.rows) rows_of[row.point].push_back(&row);
  std::vector<CellRows> cells(s.by_cell.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t k) {
    std::vector<const Row*> rows;
    for (const std::int32_t i : s.by_cell[k])
      rows.insert(rows.end(), rows_of[i].begin(), rows_of[i].end());
    cells[k] = cell_rows(p, s, map, rows);
  });
  const int n = map.lattice.size();
  NormalEquations out{Eigen::MatrixXd::Zero(3 * n + 3, 3 * n + 3), Eigen::VectorXd(3 * n + 3)};
  const Eigen::Map<const Eigen::VectorXd> u(map.control.data(), map.control.size());
  out.hessian.topLeftCorner(3 * n, 3 * n) =
      s.stiffness + p.height.precision * s.height * s.height.transpose();
  out.hessian.diagonal().tail<3>() = p.prior.precision();
  out.pull << p.height.precision * (s.wanted_height - s.height.dot(u)) * s.height - s.stiffness * u,
      -p.prior.precision().cwiseProduct(map.pose.vector());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (cells[k].pull.size() == 0) continue;
    const SplineWeights& w = s.weights[s.by_cell[k].front()];
    const auto place = [&](int q) {
      return q < 192 ? q / 64 * n + w.control[q % 64] : 3 * n + q - 192;
    };
    for (int q = 0; q < 195; ++q) {
      out.pull[place(q)] += cells[k].pull[q];
      for (int r = 0; r < 195; ++r) out.hessian(place(r), place(q)) += cells[k].hessian(r, q);
    }
  }
  out.hessian.diagonal().head(3 * n).array() +=
      kDamping * out.hessian.diagonal().head(3 * n).mean();
  return out;
}

/// The change of all unknowns that the linearised energy wants.
Eigen::VectorXd newton_step(NormalEquations e, const JawPose& pose) {
  const Eigen::Index opening = e.pull.size() - 3;
  if (opening_is_held(pose, e.pull[opening])) {
    e.hessian.row(opening).setZero();
    e.hessian.col(opening).setZero();
    e.hessian(opening, opening) = 1;
    e.pull[opening] = 0;
  }
  return e.hessian.llt().solve(e.pull);
}

SkullMap moved_by(const SkullMap& map, const Eigen::VectorXd& step, double share) {
  SkullMap next = map;
  const int n = map.lattice.size();
  next.control += share * Eigen::Map<const Eigen::MatrixX3d>(step.data(), n, 3);
  next.pose = stepped(map.pose, share * step.tail<3>());
  return next;
}

int solve_spline(const FitProblem& p, SkullMap& map, double scale, double& energy,
                 const Progress& progress) {
  const SplineSystem s = make_system(p, map, scale);
  std::vector<Vec3> x = positions_of(p, s, map);
  int it = 0;
  for (it = 1; it <= p.options.depth.max_iterations; ++it) {
    progress.step("fit", 0.2 + 0.6 * it / p.options.depth.max_iterations);
    const Standing now = standing(p.points, x, normals_of(p, map), p.skin, p.options);
    const Linearisation lin = linearise(p.points, x, now, p.skin, p.options);
    const Eigen::VectorXd step = newton_step(normal_equations(p, s, map, lin), map.pose);

    const double before = lin.energy + prior_energy(p, s, map);
    SkullMap trial = moved_by(map, step, 1);
    double share = std::min(1.0, kMostMotion / largest_motion(x, positions_of(p, s, trial)));
    std::vector<Vec3> moved;
    for (int half = 0; half <= kHalvings; ++half, share *= 0.5) {
      trial = moved_by(map, step, share);
      moved = positions_of(p, s, trial);
      energy =
          linearise(p.points, moved, now, p.skin, p.options).energy + prior_energy(p, s, trial);
      if (energy < before) break;
    }
    if (!(energy < before)) {
      energy = before;
      break;
    }
    const double motion = largest_motion(x, moved);
    map = std::move(trial);
    x = std::move(moved);
    if (motion < p.options.depth.step_tolerance) break;
  }
  return std::min(it, p.options.depth.max_iterations);
}

/// Hessian of the energy where the spline stage ended.
Eigen::MatrixXd information_at(const FitProblem& p, const SkullMap& map, double scale) {
  const SplineSystem s = make_system(p, map, scale);
  const std::vector<Vec3> x = positions_of(p, s, map);
  const Standing now = standing(p.points, x, normals_of(p, map), p.skin, p.options);
  return normal_equations(p, s, map, linearise(p.points, x, now, p.skin, p.options)).hessian;
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

/// The last stage, stiffer and stiffer until nothing folds. `least_jacobian` says whether it does.
DepthFit fit_spline(const FitProblem& problem, const SkullTemplate& skull, const CoarseFit& coarse,
                    const Progress& progress) {
  DepthFit fit{{coarse.linear,
                coarse.translation,
                SplineLattice(lattice_box(skull), problem.options.depth.spacing),
                {},
                problem.jaw,
                coarse.pose}};
  fit.iterations = coarse.iterations;
  FitOptions stiffer = problem.options;
  const FitProblem again{problem.points, problem.skin,   stiffer,       problem.jaw,
                         problem.prior,  problem.weight, problem.height};
  for (int retry = 0; retry <= kRetries; ++retry) {
    fit.map.control = Eigen::MatrixX3d::Zero(fit.map.lattice.size(), 3);
    fit.map.pose = coarse.pose;
    fit.iterations += solve_spline(again, fit.map, coarse.scale, fit.energy, progress);
    fit.bending_used = stiffer.depth.bending;
    fit.least_jacobian = least_jacobian(skull, fit.map);
    if (fit.least_jacobian >= problem.options.depth.least_jacobian) {
      fit.information = information_at(again, fit.map, coarse.scale);
      break;
    }
    stiffer.depth.bending *= kStiffer;
  }
  return fit;
}

bool folds(const DepthFit& fit) {
  return fit.information.size() == 0;
}

}  // namespace

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
                         double mouth_opening, const FitOptions& options,
                         const Progress& progress) {
  const Jaw jaw = options.depth.jaw_pose ? find_jaw(skull) : Jaw{};
  FitProblem problem{points, skin, options, jaw, kClosedJaw, {}, find_face_height(skull, jaw)};
  for (const FitPoint& p : points) problem.weight.push_back(jaw.weight(p.rest));
  progress.step("fit", 0.05);
  problem.prior = kOpenJaw;
  const CoarseFit coarse = solve_coarse(problem, start, jaw.present ? mouth_opening : 0);
  if (jaw.present && mouth_opening > 0) {
    DepthFit open = fit_spline(problem, skull, coarse, progress);
    open.mouth_open = true;
    if (!folds(open)) return open;
  }
  const bool suspect = coarse.pose.opening > kSuspect;
  problem.prior = kClosedJaw;
  // Only between two explanations are the face's height and the way along the chin's normals asked:
  // a closed face is as high as its skin says.
  std::vector<FitPoint> plain = points;
  for (FitPoint& p : plain)
    if (p.kind == FitPoint::Kind::landmark) p.normal.setZero();
  const FitProblem as_ever{plain, skin, options, jaw, kClosedJaw, problem.weight, {}};
  const FitProblem& shut = suspect ? problem : as_ever;
  DepthFit closed = fit_spline(shut, skull, solve_coarse(shut, start), progress);
  if (suspect) {
    problem.prior = kOpenJaw;
    DepthFit open = fit_spline(problem, skull, coarse, progress);
    if (!folds(open) && (folds(closed) || open.energy + kOpenMargin < closed.energy)) {
      open.mouth_open = true;
      return open;
    }
  }
  if (!folds(closed)) return closed;
  throw SolveError("the skull could not be fitted without folding: check the landmarks",
                   closed.least_jacobian, closed.iterations);
}

}  // namespace palpate::skull
