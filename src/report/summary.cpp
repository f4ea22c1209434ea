// SPDX-License-Identifier: GPL-3.0-or-later
// Medians rather than means: a region's border carries a few vertices of its neighbour. Tau-b:
// Kendall 1945, "The treatment of ties in ranking problems"; without ties it is (concordant -
// discordant) / pairs.
#include "report/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/organs.hpp"
#include "report/figures_of_map.hpp"

namespace palpate::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

nlohmann::json number(double x) {
  return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr);
}

RegionFigures figures_of(const StiffnessMap& map, SkinRegion region) {
  RegionFigures out;
  out.region = region;
  std::vector<double> stiffness, depth;
  std::vector<std::vector<double>> travel(map.forces.size());
  for (std::size_t v = 0; v < map.size(); ++v) {
    if (map.region[v] != region) continue;
    ++out.vertices;
    depth.push_back(map.depth[v]);
    if (!map.has_curve(v)) continue;
    ++out.with_curve;
    stiffness.push_back(compared_stiffness(map, v));
    const auto u = map.curve(v);
    for (std::size_t i = 0; i < u.size(); ++i) travel[i].push_back(u[i]);
  }
  out.stiffness = median(stiffness);
  out.depth = median(depth);
  for (auto& at_force : travel) out.median_u.push_back(median(at_force));
  return out;
}

int sign(double x) {
  return (x > 0) - (x < 0);
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const double at = std::clamp(q, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 == values.size()) return values.back();
  return values[i] + (at - static_cast<double>(i)) * (values[i + 1] - values[i]);
}

double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

bool stands_on_organ(const StiffnessMap& map, std::size_t vertex) {
  return map.has_curve(vertex) && lies_on_organ(map.region[vertex]);
}

std::vector<double> errors_on_bone(const StiffnessMap& map) {
  std::vector<double> error = map.error;
  for (std::size_t v = 0; v < error.size(); ++v)
    if (stands_on_organ(map, v)) error[v] = std::numeric_limits<double>::quiet_NaN();
  return error;
}

double travel_at(const StiffnessMap& map, std::size_t vertex, double force) {
  if (!map.has_curve(vertex)) return kNan;
  const auto u = map.curve(vertex);
  double f0 = 0, u0 = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (force <= map.forces[i] * (1 + 1e-12))
      return u0 + (u[i] - u0) * (force - f0) / (map.forces[i] - f0);
    f0 = map.forces[i];
    u0 = u[i];
  }
  return kNan;
}

double compared_stiffness(const StiffnessMap& map, std::size_t vertex) {
  const double u = travel_at(map, vertex, kComparedForce);
  return u > 0 ? kComparedForce / u : kNan;
}

double kendall_tau(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) throw InputError("kendall_tau: samples differ in length");
  double score = 0, differ_a = 0, differ_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int da = sign(a[i] - a[j]), db = sign(b[i] - b[j]);
      score += da * db;
      differ_a += da * da;
      differ_b += db * db;
    }
  return differ_a > 0 && differ_b > 0 ? score / std::sqrt(differ_a * differ_b) : kNan;
}

RegionSummary region_summary(const TouchableHead& head) {
  RegionSummary summary;
  for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r) {
    RegionFigures f = figures_of(head.map, static_cast<SkinRegion>(r));
    if (f.vertices > 0) summary.regions.push_back(std::move(f));
  }
  std::vector<std::pair<double, SkinRegion>> found;
  std::vector<double> ours, published;  // stiffness; place in the published order, stiff = high
  for (std::size_t place = 0; place < kPublishedOrder.size(); ++place)
    for (const RegionFigures& f : summary.regions)
      if (f.region == kPublishedOrder[place] && std::isfinite(f.stiffness)) {
        found.emplace_back(f.stiffness, f.region);
        ours.push_back(f.stiffness);
        published.push_back(-static_cast<double>(place));
      }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& x, const auto& y) { return x.first > y.first; });
  for (const auto& [stiffness, region] : found) summary.order.push_back(region);
  const double tau = kendall_tau(ours, published);
  if (std::isfinite(tau)) summary.kendall_tau = tau;
  return summary;
}

nlohmann::json to_json(const RegionSummary& summary) {
  nlohmann::json regions = nlohmann::json::object(), order = nlohmann::json::array();
  for (const RegionFigures& f : summary.regions) {
    nlohmann::json travel = nlohmann::json::array();
    for (const double u : f.median_u) travel.push_back(number(u));
    regions[std::string(name(f.region))] = {{"vertices", f.vertices},
                                            {"with_curve", f.with_curve},
                                            {"stiffness_n_per_mm", number(f.stiffness)},
                                            {"depth_mm", number(f.depth)},
                                            {"median_u_mm", travel}};
  }
  for (const SkinRegion r : summary.order) order.push_back(std::string(name(r)));
  return {{"compared_force_n", kComparedForce},
          {"regions", regions},
          {"order", order},
          {"kendall_tau",
           summary.kendall_tau ? nlohmann::json(*summary.kendall_tau) : nlohmann::json(nullptr)}};
}

}  // namespace palpate::report
