// SPDX-License-Identifier: GPL-3.0-or-later
// The fit and its error bars alone, without a sweep: in seconds, where a touchable head takes
// minutes. `bench_fit SCAN.. [--skull TRUE.ply] [--leave-out x0,x1,y0,y1,z0,z1].. [--out
// SKULL.ply]` prints per scan what the fit reports of itself and the stated SD of depth under the
// working skin's points, by region; with a true skull of the (one) scan also the error of depth,
// the share of true depths within two stated SDs, and the error beside the best constant depth over
// the face; where that skull is a fit too (as many points), also how far the two bones lie apart,
// point by point along the normal, and how often within two stated SDs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "apps/pipeline.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "report/comparison.hpp"
#include "stiffness/site_features.hpp"
#include "stiffness/uncertainty.hpp"
#include "surface/query.hpp"

namespace {

using namespace palpate;

struct Wishes {
  std::vector<std::string> scans;
  std::string skull, out;
  std::vector<Box> leave_out;
};

Box box_of(const std::string& text) {
  Box b;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf", &b.low[0], &b.high[0], &b.low[1],
                  &b.high[1], &b.low[2], &b.high[2]) != 6)
    throw InputError("--leave-out: six numbers are wanted");
  return b;
}

/// Depth under the working skin's points along the smoothed inward normal, as the map has it, and
/// its stated SD; no curves.
TouchableHead depth_only(const app::PreparedScan& scan, const app::LocatedHead& located,
                         const SkullFit& skull, const app::PipelineOptions& options) {
  const std::vector<Vec3>& points = located.head.skin.points;
  app::MappedHead mapped;
  StiffnessMap& map = mapped.map;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t n = points.size();
  map.forces = {2.0};
  map.displacement.assign(n, nan);
  map.error.assign(n, nan);
  map.status.assign(n, VertexStatus::held);
  map.region = located.head.region;
  map.depth.assign(n, nan);
  const std::vector<Vec3> normal = stiffness::smoothed_normals(located.head.skin, map.tool_radius);
  const surface::SurfaceQuery bone(skull.mesh);
  for (std::size_t v = 0; v < n; ++v)
    if (!located.head.filled[v])
      if (const auto hit = bone.cast(points[v], -normal[v], options.spread.no_bone_beyond))
        map.depth[v] = hit->distance;
  mapped.spread = stiffness::map_spread(map, located.head, skull, points, options.spread);
  TouchableHead head = app::assemble(scan, located, skull, mapped, {}, options, {});
  head.skin = scan.working.mesh;
  head.unit_mm = 1;
  return head;
}

void print_stated(const TouchableHead& head) {
  std::map<SkinRegion, std::pair<double, int>> by_region;
  double sum = 0;
  int count = 0;
  for (std::size_t v = 0; v < head.spread.depth.size(); ++v) {
    if (!std::isfinite(head.spread.depth[v])) continue;
    by_region[head.map.region[v]].first += head.spread.depth[v];
    ++by_region[head.map.region[v]].second;
    sum += head.spread.depth[v], ++count;
  }
  fmt::print("  stated SD under the skin {:.2f} mm:", sum / count);
  for (const auto& [region, s] : by_region)
    fmt::print(" {} {:.2f}", name(region), s.first / s.second);
  fmt::print("\n");
}

void print_against(const report::Comparison& c) {
  for (const report::RegionComparison& r : c.regions)
    fmt::print(
        "  {:<10} n {:6d}  depth error {:5.2f} mm, median bias {:+5.2f}, within 2 SD {:5.1f} "
        "%, stated SD {:4.2f}\n",
        name(r.region), r.vertices, r.depth_error, r.depth_bias, 100 * r.within_two_sd,
        r.stated_sd);
  fmt::print(
      "  all: depth error {:.2f} mm, within 2 SD {:.1f} %, stated SD {:.2f} mm; face {:.2f} "
      "mm against {:.2f} mm of the best constant: {:.0f} % smaller\n",
      c.all.depth_error, 100 * c.all.within_two_sd, c.all.stated_sd, c.face_error,
      c.face_constant_error, 100 * (1 - c.face_error / c.face_constant_error));
}

/// Of two fits: scanned head and face alone.
void print_apart(const SkullFit& fitted, const SkullFit& other) {
  const std::size_t n = fitted.mesh.points.size();
  if (other.mesh.points.size() != n || fitted.spread.size() != n) return;
  const std::vector<Vec3> normal = vertex_normals(other.mesh);
  std::vector<double> apart;
  std::size_t within = 0;
  for (std::size_t v = 0; v < n; ++v) {
    apart.push_back(std::abs(normal[v].dot(fitted.mesh.points[v] - other.mesh.points[v])));
    within += apart.back() <= 2 * fitted.spread[v];
  }
  std::sort(apart.begin(), apart.end());
  fmt::print(
      "  bone: {:.2f} mm apart along the normal, 95th percentile {:.2f} mm, within 2 SD {:.1f} %\n",
      std::accumulate(apart.begin(), apart.end(), 0.0) / static_cast<double>(n),
      apart[n * 95 / 100], 100.0 * static_cast<double>(within) / static_cast<double>(n));
}

void measure(const std::string& path, const Wishes& wishes) {
  const Progress silent;
  app::PipelineOptions options;
  app::StageClock clock(silent);
  auto scan = app::prepare_scan(path, options, silent, clock);
  const auto located = app::locate_head(scan, options, silent, clock);
  const SkullFit fitted = app::make_skull(located, options, silent, clock);
  const auto& s = fitted.statistics;
  fmt::print(
      "{}: within 1.5 SD {:.2f}, outside {}, least clearance {:.2f} mm, self-intersections "
      "{}, least Jacobian {:.2f}, SD of the bone {:.2f} mm; fit {:.1f} s\n",
      path, s.at("depth_rows_within_1.5_sd"), s.at("outside_count"), s.at("min_clearance_mm"),
      s.at("self_intersections"), s.at("least_jacobian"), s.at("spread_mean_mm"),
      clock.seconds().at("skull"));
  const TouchableHead estimated = depth_only(scan, located, fitted, options);
  if (!wishes.out.empty()) io::write_surface(wishes.out, estimated.skull);
  print_stated(estimated);
  if (wishes.skull.empty()) return;
  app::PipelineOptions known = options;
  known.own_skull = wishes.skull;
  const SkullFit truth = app::make_skull(located, known, silent, clock);
  print_apart(fitted, truth);
  print_against(report::compare_heads(estimated, depth_only(scan, located, truth, known),
                                      {.leave_out = wishes.leave_out}));
}

}  // namespace

int main(int argc, char** argv) {
  Wishes wishes;
  std::vector<std::string> boxes;
  CLI::App program("the fit and its error bars without a sweep");
  program.add_option("scan", wishes.scans)->required()->check(CLI::ExistingFile);
  program.add_option("--skull", wishes.skull, "true skull of the one scan")
      ->check(CLI::ExistingFile);
  program.add_option("--leave-out", boxes, "x0,x1,y0,y1,z0,z1 in the scan's unit; may repeat");
  program.add_option("--out", wishes.out, "also write the fitted skull");
  CLI11_PARSE(program, argc, argv);
  try {
    for (const std::string& box : boxes) wishes.leave_out.push_back(box_of(box));
    for (const std::string& scan : wishes.scans) measure(scan, wishes);
  } catch (const InputError& e) {
    fmt::print(stderr, "bench_fit: {}\n", e.what());
    return 2;
  }
}
