// SPDX-License-Identifier: GPL-3.0-or-later
// "Human Head Stiffness Rendering", University of Ottawa 2015, sections 4.4.1 and 4.4.2.
#include "stiffness/published_sites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "stiffness/surrogate.hpp"
#include "tetmesh/tissue.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNearestNode = 8;      // [mm] skin without a free node this near cannot be pushed
constexpr std::size_t kLeastSites = 2;  // that a blend needs

bool good(const fem::PublishedSample& sample) {
  return sample.at_rest && sample.inverted_tets == 0;
}

/// Which site is the nearest one to each spot with tissue.
std::vector<std::int32_t> nearest_sites(const Ground& ground, std::span<const std::int32_t> tissue,
                                        std::span<const std::int32_t> sites) {
  std::vector<std::int32_t> sorted(sites.begin(), sites.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> out;
  for (const std::int32_t s : tissue) {
    double best = std::numeric_limits<double>::infinity();
    std::int32_t nearest = -1;
    for (const std::int32_t site : sorted) {
      const double d =
          (ground.spots[site].frame.origin - ground.spots[s].frame.origin).squaredNorm();
      if (d < best) best = d, nearest = site;
    }
    out.push_back(nearest);
  }
  return out;
}

/// Per force, at how many sites the recipe went wrong up to it, and how.
void count_outcomes(const Ground& ground, const Checkpoint& store,
                    std::span<const std::int32_t> sites, Sweep& out) {
  for (std::size_t i = 0; i < ground.forces.size(); ++i) {
    double inverted = 0, restless = 0;
    for (const std::int32_t s : sites) {
      const SiteCurve& c = *store.find(SolveLevel::published, s);
      if (c.published.empty()) continue;
      const fem::PublishedSample& p = c.published[std::min(i, c.published.size() - 1)];
      inverted += p.inverted_tets > 0;
      restless += !p.at_rest;
    }
    out.statistics[fmt::format("sites_inverted_at_{:06.3f}_n", ground.forces[i])] = inverted;
    out.statistics[fmt::format("sites_not_at_rest_at_{:06.3f}_n", ground.forces[i])] = restless;
  }
}

void tell_outcomes(const Ground& ground, std::span<const std::int32_t> sites,
                   const std::vector<Row>& rows, Sweep& out) {
  const auto count = [&](VertexStatus status) {
    return std::count_if(sites.begin(), sites.end(),
                         [&](std::int32_t s) { return rows[s].status == status; });
  };
  const auto solved = count(VertexStatus::solved), inverted = count(VertexStatus::inverted),
             restless = count(VertexStatus::unsettled), failed = count(VertexStatus::failed);
  out.statistics["sites_solved"] = static_cast<double>(solved);
  out.statistics["sites_inverted"] = static_cast<double>(inverted);
  out.statistics["sites_unsettled"] = static_cast<double>(restless);
  out.statistics["sites_failed"] = static_cast<double>(failed);
  if (solved == static_cast<std::ptrdiff_t>(sites.size())) return;
  out.warnings.push_back(fmt::format(
      "the published recipe has a curve up to {:g} N at {} of {} sites; at {} it turns tissue "
      "inside out, at {} it does not come to rest, {} failed otherwise",
      ground.forces.back(), solved, sites.size(), inverted, restless, failed));
}

Row row_of_site(const SiteCurve& curve) {
  Row row;
  row.status = published_status(curve);
  row.method = SolveMethod::published;
  row.travel = curve.travel;
  return row;
}

}  // namespace

SiteCurve press_as_published(const TissuePiece& piece, std::span<const double> forces,
                             const std::function<void()>& after_load) {
  fem::TetMesh mesh;
  mesh.nodes = piece.nodes;
  for (const Tetrahedron& t : piece.tets) mesh.tets.insert(mesh.tets.end(), t.begin(), t.end());
  const fem::Topology topology = fem::make_topology(mesh, piece.held);
  fem::Cholesky cholesky(topology.pattern);
  SiteCurve out;
  out.method = SolveMethod::published;
  bool all_good = true;
  for (const double force : forces) {
    const auto sample = fem::press_published(topology, mesh.nodes, {}, 0, -Vec3::UnitZ(),
                                             std::span(&force, 1), cholesky);
    out.published.push_back(sample.front());
    out.travel.push_back(sample.front().displacement);
    out.iterations += sample.front().steps;
    all_good = good(sample.front());
    if (after_load) after_load();
    if (!all_good) break;  // a larger force asks no less
  }
  if (!all_good || !deepens(out.travel)) out.travel.clear();
  return out;
}

VertexStatus published_status(const SiteCurve& curve) {
  if (!curve.travel.empty()) return VertexStatus::solved;
  bool inverted = false, restless = false;
  for (const fem::PublishedSample& p : curve.published) {
    inverted = inverted || p.inverted_tets > 0;
    restless = restless || !p.at_rest;
  }
  return inverted   ? VertexStatus::inverted
         : restless ? VertexStatus::unsettled
                    : VertexStatus::failed;
}

void press_published_sites(const Ground& ground, const SkullFit& skull,
                           std::span<const std::int32_t> sites, const Shard& shard,
                           Checkpoint& store, const Progress& progress, double from, double to) {
  std::vector<std::int32_t> open;
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (static_cast<int>(i % shard.count) == shard.index &&
        !store.find(SolveLevel::published, sites[i]))
      open.push_back(sites[i]);
  if (open.empty()) return;
  tetmesh::TissueOptions meshing;
  meshing.max_volume = ground.options.published.max_volume;
  meshing.no_bone_beyond = ground.options.no_bone_beyond;
  const TissueMesh tissue = tetmesh::make_tissue_mesh(ground.head, skull, meshing, progress);
  const TissueCutter cutter(tissue);
  const double loads = static_cast<double>(open.size() * ground.forces.size());
  std::atomic<int> done = 0;
  const auto after_load = [&] { progress.step("sweep", from + (to - from) * ++done / loads); };
  parallel(static_cast<int>(open.size()), ground.options, {}, from, to, [&](int i) {
    SiteCurve curve;
    try {
      curve = press_as_published(
          cutter.take(ground.spots[open[i]].frame, ground.options.published.reach, kNearestNode,
                      TissueCutter::Start::free),
          ground.forces, after_load);
    } catch (const SolveError&) {
      curve.method = SolveMethod::published;  // no flesh there: the curve stays empty, failed
    }
    store.put(SolveLevel::published, std::span(&open[i], 1), std::span(&curve, 1));
  });
}

std::vector<Row> published_rows(const Ground& ground, const Checkpoint& store,
                                std::span<const std::int32_t> tissue,
                                std::span<const std::int32_t> sites, Sweep& out) {
  std::vector<Row> rows(ground.spots.size());
  for (std::size_t s = 0; s < rows.size(); ++s) rows[s].status = ground.spots[s].status;
  std::vector<std::uint8_t> pressed(rows.size(), 0);
  std::size_t curves = 0;
  for (const std::int32_t s : sites) {
    rows[s] = row_of_site(*store.find(SolveLevel::published, s));
    pressed[s] = 1;
    curves += rows[s].status == VertexStatus::solved;
  }
  std::unique_ptr<Surrogate> surrogate;
  if (curves >= kLeastSites && sites.size() < tissue.size()) {
    surrogate = std::make_unique<Surrogate>(ground, store, sites);
    note_left_out_errors(*surrogate, out.statistics);
  }
  const std::vector<std::int32_t> nearest = nearest_sites(ground, tissue, sites);
  for (std::size_t i = 0; i < tissue.size(); ++i) {
    const std::int32_t s = tissue[i];
    if (pressed[s]) continue;
    Row& row = rows[s];
    row.method = SolveMethod::surrogate;
    row.status = rows[nearest[i]].status;
    if (row.status != VertexStatus::solved) continue;
    const auto curve = surrogate ? surrogate->at(s) : std::nullopt;
    row.status = curve ? VertexStatus::blended : VertexStatus::failed;
    if (!curve) continue;
    row.error = curve->error;
    row.travel.assign(curve->travel.begin(), curve->travel.end());
  }
  count_outcomes(ground, store, sites, out);
  tell_outcomes(ground, sites, rows, out);
  return rows;
}

}  // namespace palpate::stiffness
