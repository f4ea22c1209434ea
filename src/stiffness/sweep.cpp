// SPDX-License-Identifier: GPL-3.0-or-later
// 1. Look around every point: normal, depth, features, status (ground.cpp).
// 2. Choose sites by farthest-point sampling of the features.
// 3. Press everything coarsely, the sites in full (press_sites.cpp); both go through the
// checkpoint.
// 4. Learn the full curves from the coarse ones (surrogate.cpp); press in full where the predicted
//    error is above the bound.
#include "stiffness/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "stiffness/fallback.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/published_sites.hpp"
#include "stiffness/sites.hpp"
#include "stiffness/surrogate.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// [-] The default patch against refined ones, 3 to 25 mm of tissue, 0.5 to 5 N
// (docs/method/sweep.md).
constexpr double kDiscretisationError = 0.02;
// Pieces of the tissue mesh against patches whose skin is clamped under the tool, six sites beside
// an ear: 12 to 36 % softer from 2.5 N on, 20 % at 2.5 N in the mean (docs/method/sweep.md).
constexpr double kClampedSkinError = 0.2;
constexpr int kFastSites = 300;      // more halves the error only at four times as many
constexpr int kPublishedSites = 40;  // seconds to minutes of one core each
constexpr double kToolPerHead =
    0.25;  // [-] a tool above this share of the head's size feels a head

void check(const HeadSurface& head, const SkullFit& skull, const SkinPoints& points,
           const SweepOptions& o) {
  if (head.skin.empty()) throw InputError("the working skin is empty; nothing to press");
  if (skull.mesh.empty()) throw InputError("the skull is empty; nothing holds the tissue");
  if (head.region.size() != head.skin.points.size())
    throw InputError("the working skin needs one region per point");
  if (points.region.size() != points.position.size())
    throw InputError("the points to press need one region each");
  for (std::size_t p = 0; p < points.position.size(); ++p)
    if (!points.position[p].allFinite())
      throw InputError(fmt::format("vertex {} has no finite position", p));
  Eigen::AlignedBox3d box;
  for (const Vec3& p : head.skin.points) box.extend(p);
  if (!(o.tool_radius > 0 && o.tool_radius <= kToolPerHead * box.sizes().minCoeff()))
    throw InputError(
        fmt::format("tool_radius is {} mm; it must be above 0 and at most {:.0f} mm, a quarter of "
                    "the head's smallest side",
                    o.tool_radius, kToolPerHead * box.sizes().minCoeff()));
  if (o.loads < 1 || !(o.max_force > 0)) throw InputError("a sweep needs loads and a force > 0");
  if (o.sites < 0 || o.sites == 1) throw InputError("a sweep needs at least 2 sites, or 0 for all");
  if (!(o.organs.give >= 0)) throw InputError("the give of organs must be >= 0");
  if (!(o.error_bound > 0)) throw InputError("the error bound must be > 0");
  if (!(o.no_bone_beyond > 0)) throw InputError("no_bone_beyond must be > 0");
  if (o.shard_count < 1 || o.shard < 0 || o.shard >= o.shard_count)
    throw InputError(fmt::format("shard {} of {} does not exist", o.shard + 1, o.shard_count));
  if (!(o.published.reach > 0)) throw InputError("the reach of the published recipe must be > 0");
  check(o.tissue);
}

std::unique_ptr<Checkpoint> open_store(const Ground& ground, Sweep& out) {
  const SweepOptions& o = ground.options;
  const std::uint64_t job = ground.fingerprint();
  auto store = o.checkpoint.empty() ? std::make_unique<Checkpoint>()
                                    : std::make_unique<Checkpoint>(o.checkpoint, job);
  for (const auto& part : o.parts) store->absorb(part, job);
  out.notes = store->damage();
  return store;
}

std::vector<std::int32_t> spots_with_tissue(const Ground& ground) {
  std::vector<std::int32_t> tissue;
  for (std::size_t s = 0; s < ground.spots.size(); ++s)
    if (ground.spots[s].status == VertexStatus::blended)
      tissue.push_back(static_cast<std::int32_t>(s));
  if (tissue.empty())
    throw InputError(fmt::format("no point of the skin has bone within {} mm beneath it",
                                 ground.options.no_bone_beyond));
  return tissue;
}

Row row_of(const SiteCurve& full, std::span<const double> forces) {
  Row row;
  row.method = full.method;
  row.status = full.travel.empty() ? VertexStatus::failed : VertexStatus::solved;
  if (full.travel.empty()) return row;
  row.error = kDiscretisationError;
  row.travel = full.travel;
  const std::size_t rings = full.sunk.size() / forces.size(), load = dent_load(forces);
  for (std::size_t r = 0; r < rings; ++r)
    row.dent.push_back(full.sunk[load * rings + r] / full.travel[load]);
  return row;
}

/// Step 4: rows of all spots that were not pressed in full; those above the bound are, now.
class Filler {
 public:
  Filler(const Ground& ground, const SkullFit& skull, Checkpoint& store,
         const std::vector<std::int32_t>& tissue, Sweep& out)
      : ground_(ground),
        skull_(skull),
        store_(store),
        tissue_(tissue),
        out_(out),
        rows_(ground.spots.size()) {
    for (std::size_t s = 0; s < rows_.size(); ++s) rows_[s].status = ground.spots[s].status;
  }

  std::vector<Row> run(const std::vector<std::int32_t>& sites, const Progress& progress) {
    take(sites);
    if (sites.size() < tissue_.size()) {
      const std::vector<std::int32_t> promoted = learn(sites, progress);
      press_sites(ground_, SolveLevel::full, promoted, {}, store_, progress, 0.97, 1);
      take(promoted);
      out_.statistics["sites_promoted"] = static_cast<double>(promoted.size());
    }
    fall_back(progress);
    admit_clamped_skin();
    give_way();
    return std::move(rows_);
  }

 private:
  /// A curve from a patch that could not follow the skin (beside an ear) says so in its error.
  void admit_clamped_skin() {
    const auto clamped = [&](SolveLevel level, std::int32_t s) {
      const SiteCurve* curve = store_.find(level, s);
      return curve && curve->bent;
    };
    for (const std::int32_t s : tissue_) {
      Row& row = rows_[s];
      if (row.travel.empty() || row.method == SolveMethod::unstructured) continue;
      if (clamped(SolveLevel::full, s) || clamped(SolveLevel::coarse, s))
        row.error = std::hypot(row.error, kClampedSkinError);
    }
  }

  /// Globes and cartilage were held while they were pressed; they give way, which is assumed.
  void give_way() {
    const OrganOptions& organs = ground_.options.organs;
    for (const std::int32_t s : tissue_) {
      Row& row = rows_[s];
      const double share = ground_.spots[s].organ;
      if (row.travel.empty() || share == 0) continue;
      for (std::size_t l = 0; l < row.travel.size(); ++l)
        row.travel[l] += share * organs.give * ground_.forces[l];
      row.error = std::hypot(row.error, share * organs.give_error);
    }
  }

  /// What failed on its patch, and in exact mode what no height field describes, on a piece of the
  /// head's own tetrahedra; these know of bone alone, so organs keep what the patch says.
  void fall_back(const Progress& progress) {
    std::vector<std::int32_t> wanted;
    double bent = 0;
    for (const std::int32_t s : tissue_) {
      const SiteCurve* full = store_.find(SolveLevel::full, s);
      if (!full) continue;
      bent += full->bent;
      if (ground_.spots[s].organ > 0) continue;
      if (full->travel.empty() || (full->bent && ground_.options.mode == SweepMode::exact))
        wanted.push_back(s);
    }
    out_.statistics["sites_with_clamped_skin"] = bent;
    press_pieces(ground_, skull_, wanted, store_, progress, out_.warnings);
    double solved = 0, failed = 0;
    for (const std::int32_t s : wanted) {
      const SiteCurve* piece = store_.find(SolveLevel::unstructured, s);
      if (piece && !piece->travel.empty()) {
        rows_[s] = row_of(*piece, ground_.forces);
        ++solved;
      }
    }
    for (const std::int32_t s : tissue_) failed += rows_[s].status == VertexStatus::failed;
    out_.statistics["sites_unstructured"] = solved;
    out_.statistics["sites_failed"] = failed;
    if (failed > 0)
      out_.warnings.push_back(fmt::format(
          "{} sites did not converge, not even on a piece of the tissue mesh where one can stand "
          "in; they have no curve",
          failed));
  }

  void take(const std::vector<std::int32_t>& sites) {
    for (const std::int32_t s : sites)
      rows_[s] = row_of(*store_.find(SolveLevel::full, s), ground_.forces);
  }

  /// Returns the spots that want a full press, in order.
  std::vector<std::int32_t> learn(const std::vector<std::int32_t>& sites,
                                  const Progress& progress) {
    const Surrogate surrogate(ground_, store_, sites);
    const bool promote = ground_.options.mode == SweepMode::fast;
    std::vector<std::uint8_t> wanted(ground_.spots.size(), 0);
    std::vector<std::int32_t> rest;
    for (const std::int32_t s : tissue_)
      if (rows_[s].method == SolveMethod::none) rest.push_back(s);
    parallel(static_cast<int>(rest.size()), ground_.options, progress, 0.95, 0.97, [&](int i) {
      const std::int32_t s = rest[i];
      const auto curve = surrogate.at(s);
      wanted[s] = !curve || (promote && !(curve->error <= ground_.options.error_bound));
      if (wanted[s]) return;
      Row& row = rows_[s];
      row.status = VertexStatus::blended;
      row.method = SolveMethod::surrogate;
      row.error = std::hypot(curve->error, kDiscretisationError);
      row.travel.assign(curve->travel.begin(), curve->travel.end());
      row.dent.assign(curve->others.begin(), curve->others.end());
    });
    note_left_out_errors(surrogate, out_.statistics);
    std::erase_if(rest, [&](std::int32_t s) { return wanted[s] == 0; });
    return rest;
  }

  const Ground& ground_;
  const SkullFit& skull_;
  Checkpoint& store_;
  const std::vector<std::int32_t>& tissue_;
  Sweep& out_;
  std::vector<Row> rows_;
};

StiffnessMap map_of(const Ground& ground, const SkinPoints& points, const std::vector<Row>& rows) {
  const std::size_t n = points.position.size(), loads = ground.forces.size();
  StiffnessMap map;
  map.tool_radius = ground.options.tool_radius;
  map.forces = ground.forces;
  map.displacement.assign(n * loads, kNan);
  map.region = points.region;
  map.dents.force = ground.forces[dent_load(ground.forces)];
  if (ground.options.mode != SweepMode::published) map.dents.radii = dent_radii(map.tool_radius);
  const std::size_t rings = map.dents.radii.size();
  map.dents.share.assign(n * rings, kNan);
  for (std::size_t p = 0; p < n; ++p) {
    const Row& row = rows[ground.spot_of[p]];
    map.status.push_back(row.status);
    map.method.push_back(row.method);
    map.error.push_back(row.error);
    map.depth.push_back(ground.spots[ground.spot_of[p]].depth);
    std::copy(row.travel.begin(), row.travel.end(), map.displacement.begin() + p * loads);
    std::copy(row.dent.begin(), row.dent.end(), map.dents.share.begin() + p * rings);
  }
  return map;
}

void summarise(const Checkpoint& store, const std::vector<std::int32_t>& sites, Sweep& out) {
  double iterations = 0, projections = 0, failed = 0, in_double = 0;
  for (const std::int32_t s : sites) {
    const SiteCurve* c = store.find(SolveLevel::full, s);
    if (!c) continue;  // another shard's
    iterations += c->iterations;
    projections += c->projections;
    failed += c->travel.empty();
    in_double += c->method == SolveMethod::in_double;
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, sites.size()));
  out.statistics["sites"] = static_cast<double>(sites.size());
  out.statistics["sites_in_double_precision"] = in_double;
  out.statistics["newton_steps_per_site"] = iterations / count;
  out.statistics["projected_steps_per_site"] = projections / count;
  out.statistics["sites_failed"] = failed;
}

void count_points(Sweep& out) {
  for (std::size_t s = 0; s < kVertexStatusNames.size(); ++s)
    out.statistics[fmt::format("points_{}", kVertexStatusNames[s])] = static_cast<double>(
        std::count(out.map.status.begin(), out.map.status.end(), static_cast<VertexStatus>(s)));
}

/// First point of each spot that was pressed.
std::vector<std::int32_t> points_of(const Ground& ground, const std::vector<std::int32_t>& sites) {
  std::vector<std::int32_t> first(ground.spots.size(), -1), out;
  for (std::size_t p = ground.spot_of.size(); p-- > 0;)
    first[ground.spot_of[p]] = static_cast<std::int32_t>(p);
  for (const std::int32_t s : sites) out.push_back(first[s]);
  return out;
}

/// Sites that a mode presses when it is not told how many.
int default_sites(SweepMode mode, std::size_t tissue) {
  switch (mode) {
    case SweepMode::fast:
      return kFastSites;
    case SweepMode::published:
      return kPublishedSites;
    case SweepMode::exact:
      break;
  }
  return static_cast<int>(tissue);
}

/// The sweep by the published recipe, from the sites on.
void sweep_published(const Ground& ground, const SkullFit& skull, const SkinPoints& points,
                     const std::vector<std::int32_t>& tissue,
                     const std::vector<std::int32_t>& sites, Checkpoint& store,
                     const Progress& progress, Sweep& out) {
  const Shard shard{ground.options.shard, ground.options.shard_count};
  press_published_sites(ground, skull, sites, shard, store, progress, 0.04, 0.95);
  out.sites = points_of(ground, sites);
  out.statistics["sites"] = static_cast<double>(sites.size());
  if (shard.count > 1) {
    out.statistics["curves_in_store"] = static_cast<double>(store.size());
    return;
  }
  out.map = map_of(ground, points, published_rows(ground, store, tissue, sites, out));
  for (std::size_t i = 0; i < sites.size(); ++i)
    out.published.push_back({out.sites[i], store.find(SolveLevel::published, sites[i])->published});
  count_points(out);
}

}  // namespace

Sweep sweep(const HeadSurface& head, const SkullFit& skull, const SkinPoints& points,
            const SweepOptions& options, const Progress& progress) {
  check(head, skull, points, options);
  const Ground ground(head, skull, points, options, progress);
  const std::vector<std::int32_t> tissue = spots_with_tissue(ground);
  Sweep out;
  const auto store = open_store(ground, out);
  const int count = options.sites > 0 ? options.sites : default_sites(options.mode, tissue.size());
  const std::vector<std::int32_t> sites = choose_sites(ground, tissue, count);
  if (options.mode == SweepMode::published) {
    sweep_published(ground, skull, points, tissue, sites, *store, progress, out);
    return out;
  }

  const Shard shard{options.shard, options.shard_count};
  const bool coarse = options.mode == SweepMode::fast && sites.size() < tissue.size();
  constexpr double kCoarseWork = 0.1;  // [-] of a full press
  const double coarse_work = coarse ? kCoarseWork * static_cast<double>(tissue.size()) : 0;
  const double middle =
      0.04 + 0.91 * coarse_work / (coarse_work + static_cast<double>(sites.size()));
  if (coarse)
    press_sites(ground, SolveLevel::coarse, tissue, shard, *store, progress, 0.04, middle);
  press_sites(ground, SolveLevel::full, sites, shard, *store, progress, middle, 0.95);
  out.sites = points_of(ground, sites);
  summarise(*store, sites, out);
  if (shard.count > 1) {
    out.statistics["curves_in_store"] = static_cast<double>(store->size());
    return out;
  }

  const std::vector<Row> rows = Filler(ground, skull, *store, tissue, out).run(sites, progress);
  out.map = map_of(ground, points, rows);
  count_points(out);
  return out;
}

Sweep sweep(const HeadSurface& head, const SkullFit& skull, const SweepOptions& options,
            const Progress& progress) {
  return sweep(head, skull, {head.skin.points, head.region}, options, progress);
}

}  // namespace palpate::stiffness
