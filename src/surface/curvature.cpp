// SPDX-License-Identifier: GPL-3.0-or-later
// A point's neighbours are written in its tangent frame, z along the outward normal, and
//   z = a0 y^2 + a1 y + a2 x^2 + a3 x + a4 + a5 xy
// is fitted by least squares. With z_x = a3, z_y = a1, z_xx = 2 a2, z_xy = a5, z_yy = 2 a0 at the
// foot and W = sqrt(1 + z_x^2 + z_y^2):
//   E = 1 + z_x^2,  F = z_x z_y,  G = 1 + z_y^2;   e = z_xx/W,  f = z_xy/W,  g = z_yy/W
//   K = (eg - f^2)/(EG - F^2),   H = (eG - 2fF + gE)/(2(EG - F^2)).
// Limit case: a sphere of radius r seen from outside is z ~ -(x^2 + y^2)/2r, so H = -1/r.
#include "surface/curvature.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "core/error.hpp"
#include "surface/point_tree.hpp"

namespace palpate::surface {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
constexpr int kFewest = 12;  // points: twice the unknowns, so that one outlier does not decide

struct Frame {
  Vec3 origin, x, y, z;
};

Frame tangent_frame(const Vec3& origin, const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 x = normal.cross(Vec3::Unit(axis)).normalized();
  return {origin, x, normal.cross(x), normal};
}

// Coefficients a0..a5 in the frame; coordinates are divided by the neighbourhood's size first, so
// that the normal equations are well conditioned in any unit.
Vec6 fit_quadric(const Frame& frame, const std::vector<PointTree::Neighbour>& found,
                 const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
  double size2 = 0;
  for (const auto& n : found) size2 = std::max(size2, n.distance2);
  if (size2 == 0) return Vec6::Zero();
  const double scale = 1 / std::sqrt(size2);
  Mat6 matrix = Mat6::Zero();
  Vec6 right = Vec6::Zero();
  for (const auto& n : found) {
    // The far side of a thin sheet (an ear, a lip) is near in space but no neighbour on the skin.
    if (normals[n.point].dot(frame.z) <= 0) continue;
    const Vec3 d = scale * (points[n.point] - frame.origin);
    const double x = frame.x.dot(d), y = frame.y.dot(d), z = frame.z.dot(d);
    Vec6 row;
    row << y * y, y, x * x, x, 1, x * y;
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += z * row;
  }
  matrix = Mat6(matrix.selfadjointView<Eigen::Lower>());
  const Eigen::LDLT<Mat6> factor(matrix);
  constexpr double kSingular = 1e-12;  // [-] pivots below this carry no information in double
  const auto pivots = factor.vectorD();
  Vec6 a = pivots.minCoeff() > kSingular * pivots.maxCoeff()
               ? Vec6(factor.solve(right))
               : Vec6(matrix.completeOrthogonalDecomposition().solve(right));
  a[0] *= scale;
  a[2] *= scale;
  a[5] *= scale;
  return a;
}

Curvature from_quadric(const Frame& frame, const Vec6& a) {
  const double zx = a[3], zy = a[1], w = std::sqrt(1 + zx * zx + zy * zy);
  const double E = 1 + zx * zx, F = zx * zy, G = 1 + zy * zy;
  const double e = 2 * a[2] / w, f = a[5] / w, g = 2 * a[0] / w;
  const double metric = E * G - F * F;
  Curvature c;
  c.gaussian = (e * g - f * f) / metric;
  c.mean = (e * G - 2 * f * F + g * E) / (2 * metric);
  const double spread = std::sqrt(std::max(0.0, c.mean * c.mean - c.gaussian));
  c.k_min = c.mean - spread;
  c.k_max = c.mean + spread;
  // (II - k I) d = 0: both rows are normal to d; the longer one is the better conditioned.
  const double r1 = e - c.k_max * E, r2 = f - c.k_max * F, r3 = g - c.k_max * G;
  Eigen::Vector2d d =
      r1 * r1 + r2 * r2 >= r2 * r2 + r3 * r3 ? Eigen::Vector2d(-r2, r1) : Eigen::Vector2d(-r3, r2);
  if (d.squaredNorm() == 0) d.x() = 1;  // umbilic: every direction is principal
  c.direction_max =
      (d.x() * (frame.x + zx * frame.z) + d.y() * (frame.y + zy * frame.z)).normalized();
  return c;
}

// `gather(tree, p, found)` lists the neighbours of p.
template <class Gather>
std::vector<Curvature> curvature(const SurfaceMesh& mesh, const Gather& gather) {
  if (const auto defect = first_defect(mesh))
    throw InputError(fmt::format("curvature needs a valid mesh: {}", *defect));
  const PointTree tree(mesh.points);
  const std::vector<Vec3> normals = vertex_normals(mesh);
  std::vector<Curvature> result(mesh.points.size());
  tbb::enumerable_thread_specific<std::vector<PointTree::Neighbour>> scratch;
  tbb::parallel_for(std::size_t{0}, mesh.points.size(), [&](std::size_t i) {
    if (normals[i].squaredNorm() == 0) return;  // no triangle touches: no tangent plane
    auto& found = scratch.local();
    gather(tree, mesh.points[i], found);
    const Frame frame = tangent_frame(mesh.points[i], normals[i]);
    result[i] = from_quadric(frame, fit_quadric(frame, found, mesh.points, normals));
  });
  return result;
}

}  // namespace

std::vector<Curvature> curvature_by_neighbours(const SurfaceMesh& mesh, int neighbours) {
  if (neighbours < 6)
    throw InputError(fmt::format("a quadric needs at least 6 neighbours, not {}", neighbours));
  return curvature(mesh, [neighbours](const PointTree& tree, const Vec3& p, auto& found) {
    tree.nearest(p, neighbours, found);
  });
}

std::vector<Curvature> curvature_by_radius(const SurfaceMesh& mesh, double radius) {
  if (!(radius > 0))
    throw InputError(fmt::format("the radius of curvature fits must be positive, not {}", radius));
  return curvature(mesh, [radius](const PointTree& tree, const Vec3& p, auto& found) {
    tree.within(p, radius, found);
    if (found.size() < kFewest) tree.nearest(p, kFewest, found);
  });
}

}  // namespace palpate::surface
