// SPDX-License-Identifier: GPL-3.0-or-later
// The closed surface at the scan's own resolution (`base`) is what all later points are projected
// on: thinning and remeshing change where points lie on the skin, not the skin.
#include "surface/repair.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "surface/conform.hpp"
#include "surface/holes.hpp"
#include "surface/pockets.hpp"
#include "surface/query.hpp"
#include "surface/remesh.hpp"
#include "surface/soup.hpp"
#include "surface/untangle.hpp"
#include "surface/wrap.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;

constexpr int kIterations = 5;     // of remeshing: edge lengths then change by less than 1 %
constexpr int kRimIterations = 2;  // after pockets are closed, to even out their rims
// [target edges] Scans are thinned to this before remeshing: coarse enough to be quick, fine enough
// that the first remeshing pass still has points to choose from.
constexpr double kThin = 0.5;
// [-] 36 pi V^2 / A^3 of the closed surface: 1 for a sphere, about 0.5 for a bust, 0.1 for a face
// mask closed across its rim; a sheet has 0. Below it nothing can be called inside.
constexpr double kFlattest = 1e-3;
constexpr double kSmallest = 10;  // [target edges] across: an object of fewer has no shape left
constexpr double kMostTriangles = 4e6;  // of the working mesh: a bust at 1 mm has 0.8 M
// [target edges] Width of gaps that a wrap bridges, which is also the size of its triangles, and
// its distance from the surface. What is wrapped has no holes left, so that gaps need not be wide.
constexpr double kWrapAlpha = 0.7, kWrapOffset = 0.1;
// [target edges] 95th percentile of the deviation beyond which the result is another shape: wrapped
// scans have about half an edge, good ones a tenth.
constexpr double kFarthest = 2.0;
// [target edges] A wrapped point farther than this from the scan has no scan nearby.
constexpr double kNearby = 0.5;

// A closed surface and which of its triangles closed a hole.
struct Base {
  SurfaceMesh mesh;
  std::vector<std::uint8_t> patch;
};

void check_scan(const SurfaceMesh& scan, const RepairOptions& options) {
  if (!(options.target_edge >= 1 && options.target_edge <= 10))
    throw InputError(fmt::format("the working edge must be 1 to 10 mm, not {}; see --edge",
                                 options.target_edge));
  if (scan.empty()) throw InputError("the scan has no triangles; give a surface mesh of a head");
  if (scan.triangles.size() > options.refuse_above)
    throw InputError(fmt::format("the scan has {} triangles, more than {}; thin it first",
                                 scan.triangles.size(), options.refuse_above));
  if (const auto defect = first_defect(scan))
    throw InputError(fmt::format("the scan is damaged: {}; export it again", *defect));
}

// One piece, open or closed, must be of a workable size and enclose something.
void check_piece(const CornerMesh& m, double edge) {
  const double across = bounding_box(m.points).size().maxCoeff();
  double area = 0;
  for (Id h = 0; h < m.half_edges(); h += 3) area += 0.5 * m.area_vector(h).norm();
  if (across < kSmallest * edge)
    throw InputError(fmt::format(
        "the scan is only {:.3g} mm across, too small for edges of {} mm; check its unit", across,
        edge));
  if (area > kMostTriangles * edge * edge * std::sqrt(3) / 4)
    throw InputError(fmt::format(
        "the scan is {:.3g} mm across with {:.3g} mm^2 of surface, too large for edges of {} mm; "
        "check its unit",
        across, area, edge));
  const double volume = capped_volume(m);
  const double roundness = 36 * std::numbers::pi * volume * volume / (area * area * area);
  if (!(roundness > kFlattest))
    throw InputError(
        fmt::format("the scan does not close into a volume ({:.0f} mm^2 of surface around {:.0f} "
                    "mm^3); a whole "
                    "head is needed",
                    area, volume));
}

// Replaces pockets by membranes. @return the base without them, and with the membranes
Base close_pockets(CornerMesh& m, const Pockets& pockets, Base base, double edge,
                   RepairReport& report, const Progress& progress) {
  const SurfaceQuery with_pockets(m.to_surface());
  std::vector<std::uint8_t> lost(base.mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, lost.size(), [&](std::size_t i) {
    const auto& [a, b, c] = base.mesh.triangles[i];
    const auto& p = base.mesh.points;
    lost[i] = pockets.face[with_pockets.closest((p[a] + p[b] + p[c]) / 3).triangle];
  });
  m.remove_faces(pockets.face);
  fill_holes(m, edge, progress);
  report.pockets_closed = pockets.count;

  std::size_t kept = 0;
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (!lost[i]) {
      base.mesh.triangles[kept] = base.mesh.triangles[i];
      base.patch[kept++] = base.patch[i];
    }
  base.mesh.triangles.resize(kept);
  base.patch.resize(kept);
  const auto shift = static_cast<Id>(base.mesh.points.size());
  base.mesh.points.insert(base.mesh.points.end(), m.points.begin(), m.points.end());
  for (Id h = 0; h < m.half_edges(); h += 3)
    if (m.patch[h / 3] == kCover) {
      base.mesh.triangles.push_back(
          {m.corner[h] + shift, m.corner[h + 1] + shift, m.corner[h + 2] + shift});
      base.patch.push_back(kCover);
    }
  return base;
}

// The wrap, remeshed and drawn back onto the scan where that keeps it free of self-intersections.
SurfaceMesh wrapped(const SurfaceMesh& mesh, const std::vector<SurfaceSample>& scan, double edge,
                    const Progress& progress) {
  progress.step("wrapping", 0);
  const SurfaceMesh wrap = alpha_wrap(mesh, kWrapAlpha * edge, kWrapOffset * edge);
  if (wrap.empty())
    throw InputError("the scan does not close into a volume; a whole head is needed");
  CornerMesh m = corner_mesh(wrap);
  remesh(m, SurfaceQuery(wrap), edge, kIterations, progress);
  conform(m, scan, edge, progress);
  return untangle(m, edge, progress) ? m.to_surface() : wrap;
}

// Points and triangle middles of the scan's part of the base, thinned where there are very many.
std::vector<SurfaceSample> scan_samples(const Base& base) {
  constexpr std::size_t kEnough = 400'000;  // ten per triangle of a working mesh
  std::vector<SurfaceSample> samples;
  const auto& p = base.mesh.points;
  const std::size_t stride = 1 + 2 * base.mesh.triangles.size() / kEnough;
  for (std::size_t i = 0; i < base.mesh.triangles.size(); i += stride) {
    if (base.patch[i] != kScan) continue;
    const auto& [a, b, c] = base.mesh.triangles[i];
    const Vec3 normal = (p[b] - p[a]).cross(p[c] - p[a]).stableNormalized();
    samples.push_back({(p[a] + p[b] + p[c]) / 3, normal});
    samples.push_back({p[i / stride % 3 == 0 ? a : i / stride % 3 == 1 ? b : c], normal});
  }
  return samples;
}

void flag_filled(WorkingSurface& w, const SurfaceQuery& query, const Base& base, double nearby) {
  w.filled.resize(w.mesh.points.size());
  tbb::parallel_for(std::size_t{0}, w.filled.size(), [&](std::size_t v) {
    const ClosestPoint c = query.closest(w.mesh.points[v]);
    w.filled[v] = base.patch[c.triangle] != kScan || c.distance > nearby;
  });
}

// Points of a wrap that came from a closed hole, and their neighbours.
std::vector<std::uint8_t> near_covers(const SurfaceMesh& wrap, const SurfaceQuery& query,
                                      const Base& base) {
  std::vector<std::uint8_t> cover(wrap.points.size());
  tbb::parallel_for(std::size_t{0}, cover.size(), [&](std::size_t v) {
    cover[v] = base.patch[query.closest(wrap.points[v]).triangle] != kScan;
  });
  std::vector<std::uint8_t> near = cover;
  for (const auto& [a, b, c] : wrap.triangles)
    if (cover[a] || cover[b] || cover[c]) near[a] = near[b] = near[c] = 1;
  return near;
}

double percentile_95(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Distance of the scan's points to the working surface: of all, and of those that neither lie in a
// pocket nor blend into a cover.
void measure_deviation(const std::vector<Vec3>& scan, const SurfaceMesh& working,
                       const std::vector<std::uint8_t>& near_cover,
                       const SurfaceQuery* with_pockets, const Pockets& pockets,
                       RepairReport& report) {
  const SurfaceQuery query(working);
  std::vector<double> all(scan.size()), skin(scan.size());
  tbb::parallel_for(std::size_t{0}, scan.size(), [&](std::size_t i) {
    const ClosestPoint c = query.closest(scan[i]);
    const auto& [u, v, w] = working.triangles[c.triangle];
    bool closed = near_cover[u] || near_cover[v] || near_cover[w];
    if (!closed && with_pockets) closed = pockets.face[with_pockets->closest(scan[i]).triangle];
    all[i] = c.distance;
    skin[i] = closed ? -1 : c.distance;
  });
  std::erase(skin, -1);
  report.deviation_p95_mm = percentile_95(skin);
  report.deviation_all_p95_mm = percentile_95(all);
}

void check_result(const RepairReport& report, double edge) {
  if (report.deviation_p95_mm > kFarthest * edge)
    throw InputError(fmt::format(
        "the scan passes through itself too often: repair missed 5 % of it by more than {:.1f} mm; "
        "clean it in a mesh editor",
        report.deviation_p95_mm));
}

void describe(RepairReport& r) {
  const auto count = [&](std::size_t n, const char* what) {
    if (n > 0) r.lines.push_back(fmt::format("{} {}", n, what));
  };
  count(r.duplicate_points, "repeated points were welded");
  count(r.duplicate_faces, "repeated triangles were dropped");
  count(r.degenerate_faces, "triangles without area were dropped");
  count(r.nonmanifold_spots, "non-manifold edges or points were taken apart");
  if (r.components > 1)
    r.lines.push_back(fmt::format("the largest of {} pieces was kept; the others had {} triangles",
                                  r.components, r.dropped_triangles));
  if (r.winding_inverted) r.lines.push_back("triangles faced inwards and were turned round");
  if (r.holes_filled > 0)
    r.lines.push_back(fmt::format("{} holes were closed; the largest has a rim of {:.0f} mm",
                                  r.holes_filled, r.largest_hole_mm));
  count(r.pockets_closed, "pockets (eye sockets, mouth, nostrils) were closed");
  if (r.decimated_from > 0)
    r.lines.push_back(
        fmt::format("{} triangles were thinned for the working mesh", r.decimated_from));
  if (r.wrapped) r.lines.push_back("the surface passed through itself and was wrapped");
  r.lines.push_back(
      fmt::format("95 % of the scan's points on open skin lie within {:.2f} mm of the working mesh",
                  r.deviation_p95_mm));
}

}  // namespace

WorkingSurface make_working_surface(const SurfaceMesh& scan, const RepairOptions& options,
                                    const Progress& progress) {
  check_scan(scan, options);
  const double edge = options.target_edge;
  WorkingSurface w;
  RepairReport& report = w.report;
  progress.step("cleaning the scan", 0);
  CornerMesh m = manifold_from_soup(scan, report);
  const std::vector<Vec3> scan_points = m.points;
  if (scan.triangles.size() > options.decimate_above) report.decimated_from = scan.triangles.size();

  check_piece(m, edge);
  const HoleStatistics holes = fill_holes(m, edge, progress);
  report.holes_filled = holes.filled;
  report.largest_hole_mm = holes.largest_perimeter;
  check_piece(m, edge);

  Base base{m.to_surface(), m.patch};
  auto query = std::make_unique<SurfaceQuery>(base.mesh);
  thin(m, kThin * edge, progress);
  remesh(m, *query, edge, kIterations, progress);

  const Pockets pockets = find_pockets(m, edge, progress);
  std::unique_ptr<SurfaceQuery> with_pockets;
  if (pockets.count > 0) {
    with_pockets = std::make_unique<SurfaceQuery>(m.to_surface());
    base = close_pockets(m, pockets, std::move(base), edge, report, progress);
    query = std::make_unique<SurfaceQuery>(base.mesh);
    remesh(m, *query, edge, kRimIterations, progress);
  }

  blend_covers(m);
  const std::vector<SurfaceSample> samples = scan_samples(base);
  conform(m, samples, edge, progress);
  const SurfaceMesh tangled = m.to_surface();
  report.wrapped = !untangle(m, edge, progress);
  std::vector<std::uint8_t> near_cover = near_covers(m);
  w.mesh = m.to_surface();
  if (report.wrapped) {
    w.mesh = wrapped(tangled, samples, edge, progress);
    near_cover = near_covers(w.mesh, *query, base);
  }
  flag_filled(w, *query, base, kNearby * edge);
  measure_deviation(scan_points, w.mesh, near_cover, with_pockets.get(), pockets, report);
  check_result(report, edge);
  describe(report);
  return w;
}

}  // namespace palpate::surface
