// SPDX-License-Identifier: GPL-3.0-or-later
// "Human Head Stiffness Rendering" (University of Ottawa, 2015), section 4.3. The source gives the
// two algorithms and leaves open the two control-point weights, how difference vectors become
// control displacements, the directions that each region allows and the fall of the region weight.
// The choices made here are listed in docs/method/fit.md.
#include "skull/published.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/error.hpp"
#include "registration/place.hpp"

namespace palpate::skull {
namespace {

struct RegionTask {
  SkullRegion region;
  Vec3 directions;  ///< 1 where a control point may move along that axis of the head frame
};

/// Both levels, parents first. A region moves along the axes that its surface faces: the vault
/// everywhere; forehead, chin and eyebrow forwards and up or down; the orbit's rim forwards; the
/// cheekbone forwards and sideways; the jaw sideways, down and forwards.
const std::array<RegionTask, 7> kHierarchy = {{{SkullRegion::cranium, {1, 1, 1}},
                                               {SkullRegion::jaw, {1, 1, 1}},
                                               {SkullRegion::orbit, {0, 0, 1}},
                                               {SkullRegion::forehead, {0, 1, 1}},
                                               {SkullRegion::chin, {0, 1, 1}},
                                               {SkullRegion::eyebrow, {0, 1, 1}},
                                               {SkullRegion::cheekbone, {1, 0, 1}}}};

std::vector<Vec3> points_of(const SurfaceMesh& mesh, const std::vector<SkullRegion>& region,
                            SkullRegion active) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    if (region[i] == active) points.push_back(mesh.points[i]);
  return points;
}

double cell_sphere_radius(const BernsteinLattice& lattice) {
  const Vec3 cells(lattice.cells[0], lattice.cells[1], lattice.cells[2]);
  return 0.5 * lattice.box.size().cwiseQuotient(cells).norm();
}

bool close_to(const Box& box, const Vec3& p, double reach) {
  return (p.cwiseMax(box.low).cwiseMin(box.high) - p).norm() <= reach;
}

/// Moves each control point in or close to the region's box by the mean difference vector
/// (head - region) of the region's points within one cell's sphere of it, or of the nearest one,
/// along the allowed axes.
void displace_control_points(BernsteinLattice& lattice, const std::vector<Vec3>& region_points,
                             const std::vector<Vec3>& differences, const Vec3& directions) {
  const double radius = cell_sphere_radius(lattice);
  const Box box = bounding_box(region_points);
  for (std::size_t c = 0; c < lattice.rest.size(); ++c) {
    if (!close_to(box, lattice.rest[c], radius)) continue;
    Vec3 sum = Vec3::Zero();
    int count = 0;
    double nearest = 1e300;
    std::size_t at = 0;
    for (std::size_t i = 0; i < region_points.size(); ++i) {
      const double distance = (region_points[i] - lattice.rest[c]).norm();
      if (distance <= radius) {
        sum += differences[i];
        ++count;
      }
      if (distance < nearest) {
        nearest = distance;
        at = i;
      }
    }
    const Vec3 mean = count > 0 ? Vec3(sum / count) : differences[at];
    lattice.moved[c] = lattice.rest[c] + directions.cwiseProduct(mean);
  }
}

/// Algorithm 2 for one region.
void deform_region(SkullTemplate& skull, const RegionTask& task, const surface::SurfaceQuery& head,
                   const PublishedFitOptions& options) {
  const std::vector<Vec3> points = points_of(skull.mesh, skull.region, task.region);
  if (points.empty())
    throw InputError(
        fmt::format("the skull template has no vertex in the region {}", name(task.region)));
  std::vector<Vec3> differences;
  for (const Vec3& p : points) differences.push_back(head.closest(p).point - p);

  BernsteinLattice lattice = make_lattice(bounding_box(skull.mesh.points), options.cells);
  weigh_control_points(lattice, head, options);
  displace_control_points(lattice, points, differences, task.directions);

  const std::vector<double> share = region_weights(skull.mesh, skull.region, task.region, options);
  const std::vector<Vec3> before = skull.mesh.points;
  for (std::size_t i = 0; i < before.size(); ++i)
    skull.mesh.points[i] += share[i] * (deform(lattice, before[i], options.form) - before[i]);

  // A landmark moves with the mesh: with the share of the nearest vertex.
  for (auto& [code, landmark] : skull.landmarks) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < before.size(); ++i)
      if ((before[i] - landmark.position).squaredNorm() <
          (before[nearest] - landmark.position).squaredNorm())
        nearest = i;
    landmark.position += skull.mesh.points[nearest] - before[nearest];
  }
}

}  // namespace

void weigh_control_points(BernsteinLattice& lattice, const surface::SurfaceQuery& head,
                          const PublishedFitOptions& options) {
  const double radius = cell_sphere_radius(lattice);
  for (std::size_t c = 0; c < lattice.rest.size(); ++c) {
    const bool near = head.closest(lattice.rest[c], radius).triangle >= 0;
    lattice.weight[c] = near ? options.heavy_weight : options.light_weight;
  }
}

std::vector<double> region_weights(const SurfaceMesh& mesh, const std::vector<SkullRegion>& region,
                                   SkullRegion active, const PublishedFitOptions& options) {
  const std::vector<Vec3> inside = points_of(mesh, region, active);
  std::vector<double> weights(mesh.points.size(), 1.0);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (region[i] == active) continue;
    double nearest2 = options.outside_reach * options.outside_reach;
    for (const Vec3& p : inside) nearest2 = std::min(nearest2, (p - mesh.points[i]).squaredNorm());
    const double part = std::sqrt(nearest2) / options.outside_reach;
    weights[i] = options.outside_near + part * (options.outside_far - options.outside_near);
  }
  return weights;
}

SkullFit fit_published(const HeadSurface& head, const SkullTemplate& skull,
                       const FitOptions& options, const Progress& progress) {
  const registration::Placement placement = registration::place_published(head, skull);
  SkullTemplate fitted = registration::placed(skull, placement);
  const surface::SurfaceQuery query(head.skin);
  for (std::size_t r = 0; r < kHierarchy.size(); ++r) {
    progress.step("fit", double(r) / kHierarchy.size());
    deform_region(fitted, kHierarchy[r], query, options.published);
  }
  SkullFit fit;
  fit.mesh = std::move(fitted.mesh);
  fit.region = std::move(fitted.region);
  fit.landmarks = std::move(fitted.landmarks);
  fit.warnings = placement.warnings;
  fit.statistics["placement_rms_mm"] = placement.rms_mm;
  for (const auto& [pair, left] : placement.residuals_mm)
    fit.statistics["placement_residual_" + pair + "_mm"] = left;
  return fit;
}

}  // namespace palpate::skull
