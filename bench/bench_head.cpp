// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of the sweep on the bundled head: CPU seconds per site of exact and coarse presses for
// several numbers of sites (is it linear?), what 10 000 sites cost at that rate, peak memory; with
// `--full-mesh N` also the same presses at N sites on the whole head's tetrahedra, in double
// precision, for scale. `bench_head --help` says what can be set.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>

#include "apps/pipeline.hpp"
#include "fem/press.hpp"
#include "stiffness/fallback.hpp"
#include "stiffness/press_sites.hpp"
#include "stiffness/sites.hpp"

namespace {

using namespace palpate;
using namespace palpate::stiffness;

double cpu_seconds() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(u.ru_utime) + seconds(u.ru_stime);
}
double peak_gib() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_maxrss) / (1024.0 * 1024.0);
}

struct Wishes {
  std::string head = fmt::format("{}/data/head.ply", PALPATE_SOURCE_DIR);
  std::vector<int> sites = {200, 400, 800};
  double radius = 8;
  int full_mesh = 0;
  bool coarse_only = false;
};

/// CPU seconds of one press with ten loads on the whole head, linear elements, all unknowns.
double press_whole_head(const Ground& ground, const TissueMesh& tissue, std::int32_t site) {
  const SiteFrame& frame = ground.spots[site].frame;
  fem::TetMesh mesh;
  for (const Vec3& p : tissue.nodes)
    mesh.nodes.push_back(frame.axes.transpose() * (p - frame.origin));
  for (std::size_t t = 0; t < tissue.tets.size(); ++t)
    if (tissue.label[t] == TissueLabel::flesh)
      mesh.tets.insert(mesh.tets.end(), tissue.tets[t].begin(), tissue.tets[t].end());
  std::vector<std::uint8_t> used(mesh.nodes.size(), 0), held = tissue.held;
  for (const std::int32_t n : mesh.tets) used[n] = 1;
  for (std::size_t n = 0; n < used.size(); ++n)
    if (!used[n]) held[n] = 1;
  fem::FaceList touchable;
  const fem::FaceList faces = fem::boundary_faces(mesh);
  for (std::size_t f = 0; f < faces.size(); f += 3) {
    bool skin = true;
    for (int i = 0; i < 3; ++i)
      skin = skin && static_cast<std::size_t>(faces[f + i]) < tissue.skin_points &&
             mesh.nodes[faces[f + i]].norm() < 16;
    if (skin) touchable.insert(touchable.end(), &faces[f], &faces[f] + 3);
  }
  const double before = cpu_seconds();
  const fem::Topology topology = fem::make_topology(mesh, held, touchable);
  fem::Cholesky cholesky(topology.pattern);
  const SiteCurve curve =
      press_body(topology, mesh.nodes, fem::neo_hookean(fem::lame_moduli(0.045658, 0.43)),
                 {ground.options.tool_radius, 5}, ground.forces, {}, cholesky);
  const double seconds = cpu_seconds() - before;
  fmt::print("  site {:6d}: {} unknowns, {} Newton steps, {:.1f} CPU s{}\n", site,
             topology.unknowns(), curve.iterations, seconds,
             curve.travel.empty() ? " (did not converge)" : "");
  return seconds;
}

/// What exact mode presses on pieces of the tissue mesh; prints and returns its CPU seconds,
/// without those of making the tissue mesh, once per head.
double press_folds(const Ground& ground, const SkullFit& skull, std::span<const std::int32_t> sites,
                   Checkpoint& store) {
  std::vector<std::int32_t> folds;
  for (const std::int32_t s : sites) {
    const SiteCurve& c = *store.find(SolveLevel::full, s);
    if (c.bent || c.travel.empty()) folds.push_back(s);
  }
  if (folds.empty()) return 0;
  const Progress silent;
  const double start = cpu_seconds();
  (void)tetmesh::make_tissue_mesh(ground.head, skull, {}, silent);
  const double mesh = cpu_seconds() - start;
  std::vector<std::string> warnings;
  press_pieces(ground, skull, folds, store, silent, warnings);
  const double seconds = std::max(cpu_seconds() - start - 2 * mesh, 0.0);
  fmt::print(
      "  of these {} beside folds on pieces of the tissue mesh: {:.1f} s, tissue mesh {:.1f} s\n",
      folds.size(), seconds, mesh);
  for (const std::string& w : warnings) fmt::print("  {}\n", w);
  return seconds;
}

}  // namespace

int main(int argc, char** argv) {
  Wishes wishes;
  CLI::App program("cost of the sweep: CPU seconds per site, linearity, memory");
  program.add_option("--head", wishes.head, "scan to sweep; the bundled head")
      ->check(CLI::ExistingFile);
  program.add_option("--sites", wishes.sites, "numbers of sites, ascending; 200,400,800")
      ->delimiter(',');
  program.add_option("--radius", wishes.radius, "of the tool [mm]; 8")
      ->check(CLI::Range(1.0, 30.0));
  program.add_option("--full-mesh", wishes.full_mesh,
                     "also press this many sites on the whole head's mesh, minutes each; 0");
  program.add_flag("--coarse", wishes.coarse_only, "only the coarse presses of the fast mode");
  CLI11_PARSE(program, argc, argv);
  const Progress silent;
  app::PipelineOptions options;
  options.sweep.mode = SweepMode::exact;
  options.sweep.tool_radius = wishes.radius;
  app::StageClock clock(silent);
  auto scan = app::prepare_scan(wishes.head, options, silent, clock);
  const auto located = app::locate_head(scan, options, silent, clock);
  const SkullFit skull = app::make_skull(located, options, silent, clock);
  const Ground ground(located.head, skull, {located.points, located.region}, options.sweep, silent);
  std::vector<std::int32_t> tissue;
  for (std::size_t s = 0; s < ground.spots.size(); ++s)
    if (ground.spots[s].status == VertexStatus::blended)
      tissue.push_back(static_cast<std::int32_t>(s));
  fmt::print("{} vertices, {} on tissue; sphere of {} mm, {} loads; CPU seconds\n",
             located.points.size(), tissue.size(), wishes.radius, ground.forces.size());

  double per_site[2] = {0, 0};
  for (const SolveLevel level : {SolveLevel::coarse, SolveLevel::full}) {
    if (wishes.coarse_only && level == SolveLevel::full) continue;
    for (const int count : wishes.sites) {
      std::vector<std::int32_t> sites;  // evenly over the head's own order
      for (int i = 0; i < count; ++i)
        sites.push_back(tissue[static_cast<std::size_t>(i) * tissue.size() / count]);
      Checkpoint store;
      const double before = cpu_seconds();
      press_sites(ground, level, sites, {}, store, silent, 0, 1);
      double seconds = cpu_seconds() - before;
      if (level == SolveLevel::full) seconds += press_folds(ground, skull, sites, store);
      double steps = 0, in_double = 0, failed = 0;
      for (const std::int32_t s : sites) {
        const SiteCurve& c = *store.find(level, s);
        steps += c.iterations;
        in_double += c.method == SolveMethod::in_double;
        failed += c.travel.empty();
      }
      per_site[level == SolveLevel::full] = seconds / count;
      fmt::print(
          "{:<7}{:6d} sites: {:8.1f} s, {:7.2f} ms/site, {:5.1f} steps/site, {} in double, {} "
          "failed, peak {:.2f} GiB\n",
          level == SolveLevel::full ? "exact" : "coarse", count, seconds, 1e3 * seconds / count,
          steps / count, in_double, failed, peak_gib());
    }
  }
  if (wishes.coarse_only) return 0;
  const double exact = 1e4 * per_site[1], fast = 1e4 * per_site[0] + 300 * per_site[1];
  fmt::print(
      "10 000 sites at these rates, two cores without other load: exact {:.1f} min, fast {:.1f} "
      "min "
      "(300 full presses, without promotions)\n",
      exact / 120, fast / 120);
  if (wishes.full_mesh == 0) return 0;
  const TissueMesh mesh = tetmesh::make_tissue_mesh(located.head, skull, options.tissue, silent);
  fmt::print("whole head, static Newton, linear elements:\n");
  double sum = 0;
  for (int i = 0; i < wishes.full_mesh; ++i)
    sum += press_whole_head(ground, mesh,
                            tissue[(2 * i + 1) * tissue.size() / (2 * wishes.full_mesh)]);
  sum /= wishes.full_mesh;
  fmt::print("whole head over exact {:.0f}x, over fast {:.0f}x\n", sum / per_site[1],
             1e4 * sum / fast);
}
