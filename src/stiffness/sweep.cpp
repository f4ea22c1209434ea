// SPDX-License-Identifier: GPL-3.0-or-later
// 1. Look around every point: normal, depth, features, status.
// 2. Choose sites by farthest-point sampling of the features.
// 3. Press each site in full on its local patch.
// 4. Learn the curves from the features; carry them to all other points with an error estimate.
#include "stiffness/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "stiffness/blend.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/site_features.hpp"
#include "stiffness/sites.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
// [-] The default patch against refined ones, 3 to 25 mm of tissue, 0.5 to 5 N
// (docs/method/sweep.md).
constexpr double kDiscretisationError = 0.02;
void check(const HeadSurface& head, const SkullFit& skull, const SweepOptions& o) {
  if (head.skin.empty()) throw InputError("the working skin is empty; nothing to press");
  if (skull.mesh.empty()) throw InputError("the skull is empty; nothing holds the tissue");
  if (head.region.size() != head.skin.points.size())
    throw InputError("the working skin needs one region per point");
  if (!(o.tool_radius > 0 && o.tool_radius <= 50))
    throw InputError(fmt::format("tool radius is {} mm; it must be in (0, 50]", o.tool_radius));
  if (o.loads < 1 || !(o.max_force > 0)) throw InputError("a sweep needs loads and a force > 0");
  if (o.sites < 2) throw InputError("a sweep needs at least 2 sites");
  if (!(o.no_bone_beyond > 0)) throw InputError("no_bone_beyond must be > 0");
}

bool is_organ(SkinRegion r) {
  return r == SkinRegion::eye || r == SkinRegion::nose || r == SkinRegion::lips;
}

/// Step 1. Fills depth and status of the map; `blended` marks a point that is to have a curve.
std::vector<SiteFeatures> look_around(const Ground& ground, StiffnessMap& map,
                                      const Progress& progress) {
  const int n = static_cast<int>(map.size());
  std::vector<SiteFeatures> features(n);
  parallel(n, ground.options, progress, 0, 0.05, [&](int p) {
    const SiteFrame& frame = ground.frames[p];
    const auto found =
        site_features(frame, ground.options.tool_radius, ground.skin, ground.bone, ground.limits);
    if (found && !leaves_tissue(frame, found->depth, ground.skin)) {
      features[p] = *found;
      map.depth[p] = found->depth;
    }
    const SkinRegion region = map.region[p];
    if (is_organ(region))
      map.status[p] = VertexStatus::held;
    else if (std::isnan(map.depth[p]) || region == SkinRegion::ear)
      map.status[p] = VertexStatus::no_bone;
    else
      map.status[p] = VertexStatus::blended;
  });
  return features;
}

/// Step 2. What moves the curve most counts most: depths and curvatures in full, their unevenness
/// around the site less; position in addition, so that no part of the head is left without a site.
std::vector<std::int32_t> choose_sites(const Ground& ground, const StiffnessMap& map,
                                       const std::vector<SiteFeatures>& features) {
  constexpr double kUnevenness = 0.3;  // [-]
  constexpr double kPosition = 0.35;   // [-] per tool radius; more spreads sites evenly in space
  std::vector<std::int32_t> candidates;
  for (std::size_t p = 0; p < map.size(); ++p)
    if (map.status[p] == VertexStatus::blended) candidates.push_back(static_cast<int>(p));
  if (candidates.empty()) return {};
  const Eigen::Index s = features[candidates[0]].shape.size();
  Eigen::RowVectorXd weight = Eigen::RowVectorXd::Ones(s);
  for (Eigen::Index r = 1; r < s; r += 5)
    weight[r + 1] = weight[r + 2] = weight[r + 4] = kUnevenness;
  Eigen::MatrixXd inputs(candidates.size(), s + 3);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    inputs.row(i).head(s) = features[candidates[i]].shape.transpose().cwiseProduct(weight);
    inputs.row(i).tail(3) =
        kPosition / ground.options.tool_radius * ground.head.skin.points[candidates[i]];
  }
  std::vector<std::int32_t> sites =
      farthest_points(inputs, ground.options.sites, ground.options.seed);
  for (std::int32_t& i : sites) i = candidates[i];
  return sites;
}

void store(StiffnessMap& map, std::size_t p, const Eigen::VectorXd& travel, double error) {
  std::copy(travel.begin(), travel.end(), map.displacement.begin() + p * map.forces.size());
  map.error[p] = error;
}

/// Step 4. The learned curves on all points that have none yet.
void blend(const Ground& ground, const std::vector<SiteFeatures>& features,
           const PressedSites& solved, Sweep& out, const Progress& progress) {
  const double per_radius = 1 / ground.options.tool_radius;
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < out.sites.size(); ++i)
    if (!solved.curves[i].travel.empty()) good.push_back(i);
  const auto n = static_cast<Eigen::Index>(good.size());
  if (n < 2) throw SolveError("fewer than two sites were solved; no map can be made");
  BlendInputs inputs{Eigen::MatrixXd(n, features[out.sites[0]].shape.size()),
                     Eigen::MatrixXd(n, 3)};
  Eigen::MatrixXd travel(n, static_cast<Eigen::Index>(ground.forces.size()));
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::int32_t p = out.sites[good[i]];
    inputs.shape.row(i) = features[p].shape;
    inputs.position.row(i) = per_radius * ground.head.skin.points[p];
    travel.row(i) =
        Eigen::Map<const Eigen::VectorXd>(solved.curves[good[i]].travel.data(), travel.cols());
  }
  const CurveBlend learned(std::move(inputs), travel);
  parallel(static_cast<int>(out.map.size()), ground.options, progress, 0.96, 1, [&](int p) {
    if (out.map.status[p] != VertexStatus::blended) return;
    const auto curve = learned.at(features[p].shape, per_radius * ground.head.skin.points[p]);
    store(out.map, p, curve.travel, std::hypot(curve.error, kDiscretisationError));
  });

  std::vector<double> miss(learned.left_out_errors().size());
  std::transform(learned.left_out_errors().data(), learned.left_out_errors().data() + miss.size(),
                 miss.begin(), [](double e) { return std::abs(e); });
  std::sort(miss.begin(), miss.end());
  out.statistics["blend_left_out_error_median"] = miss[miss.size() / 2];
  out.statistics["blend_left_out_error_p95"] = miss[miss.size() * 95 / 100];
  out.statistics["blend_left_out_error_max"] = miss.back();
}

StiffnessMap empty_map(const Ground& ground) {
  const std::size_t n = ground.head.skin.points.size();
  StiffnessMap map;
  map.tool_radius = ground.options.tool_radius;
  map.forces = ground.forces;
  map.displacement.assign(n * ground.forces.size(), kNan);
  map.status.assign(n, VertexStatus::failed);
  map.error.assign(n, kNan);
  map.depth.assign(n, kNan);
  map.region = ground.head.region;
  return map;
}

void summarise(const PressedSites& solved, Sweep& out) {
  double iterations = 0, projections = 0, failed = 0;
  for (const SiteCurve& c : solved.curves) {
    iterations += c.iterations;
    projections += c.projections;
    failed += c.travel.empty();
  }
  const double sites = static_cast<double>(std::max<std::size_t>(1, solved.curves.size()));
  out.statistics["sites"] = static_cast<double>(solved.curves.size());
  out.statistics["sites_failed"] = failed;
  out.statistics["sites_in_double_precision"] = solved.in_double;
  out.statistics["sites_with_clamped_skin"] = solved.clamped;
  out.statistics["newton_steps_per_site"] = iterations / sites;
  out.statistics["projected_steps_per_site"] = projections / sites;
  for (std::size_t s = 0; s < kVertexStatusNames.size(); ++s)
    out.statistics[fmt::format("points_{}", kVertexStatusNames[s])] = static_cast<double>(
        std::count(out.map.status.begin(), out.map.status.end(), static_cast<VertexStatus>(s)));
  if (failed > 0)
    out.warnings.push_back(fmt::format("{} of {} sites did not converge; they have no curve",
                                       failed, solved.curves.size()));
}

}  // namespace

Sweep sweep(const HeadSurface& head, const SkullFit& skull, const SweepOptions& options,
            const Progress& progress) {
  check(head, skull, options);
  const Ground ground(head, skull, options);
  Sweep out;
  out.map = empty_map(ground);
  const std::vector<SiteFeatures> features = look_around(ground, out.map, progress);
  out.sites = choose_sites(ground, out.map, features);
  if (out.sites.empty())
    throw InputError(fmt::format("no point of the skin has bone within {} mm beneath it",
                                 options.no_bone_beyond));
  const PressedSites solved = press_sites(ground, out.sites, out.map.depth, progress, 0.05, 0.95);
  blend(ground, features, solved, out, progress);
  for (std::size_t i = 0; i < out.sites.size(); ++i) {
    const std::int32_t p = out.sites[i];
    const std::vector<double>& travel = solved.curves[i].travel;
    out.map.status[p] = travel.empty() ? VertexStatus::failed : VertexStatus::solved;
    const auto loads = static_cast<Eigen::Index>(ground.forces.size());
    if (travel.empty())
      store(out.map, p, Eigen::VectorXd::Constant(loads, kNan), kNan);
    else
      store(out.map, p, Eigen::Map<const Eigen::VectorXd>(travel.data(), loads),
            kDiscretisationError);
  }
  summarise(solved, out);
  return out;
}

}  // namespace palpate::stiffness
