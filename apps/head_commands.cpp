// SPDX-License-Identifier: GPL-3.0-or-later
// What can be done with a finished head: look into it, export it, write its report.
#include <fmt/format.h>

#include <algorithm>

#include "apps/command_line.hpp"
#include "apps/describe.hpp"
#include "apps/terminal_progress.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "io/head_file.hpp"
#include "landmarks/regions.hpp"
#include "report/published.hpp"
#include "report/report.hpp"
#include "report/summary.hpp"

namespace palpate::app {
namespace {

void add_head_argument(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("HEAD", c->input, "touchable head, .glb, as `palpate build` writes it")
      ->required();
}

/// What the published recipe did at its sites; empty for a head of the default preset.
std::string published_text(const TouchableHead& head) {
  const std::vector<report::PublishedLoad> loads = report::published_loads(head);
  if (loads.empty()) return "";
  std::string text =
      fmt::format("published recipe, {} sites pressed\n{:>9} {:>14} {:>12} {:>6} {:>16} {:>16}\n",
                  loads.front().sites, "force [N]", "inside out at", "no rest at", "good",
                  "u of these [mm]", "u as told [mm]");
  for (const report::PublishedLoad& l : loads)
    text += fmt::format("{:>9.3f} {:>14} {:>12} {:>6} {:>16.2f} {:>16.2f}\n", l.force, l.inverted,
                        l.restless, l.good, l.median_good_u, l.median_u);
  return text;
}

void run_inspect(Command& c) {
  const TouchableHead head = io::read_head(c.input);
  const report::RegionSummary summary = report::region_summary(head);
  std::string text = fmt::format("{} vertices, {} triangles, {} mm per unit; skull {} vertices\n",
                                 head.skin.points.size(), head.skin.triangles.size(), head.unit_mm,
                                 head.skull.points.size());
  text += fmt::format("{:<10} {:>8} {:>10} {:>14} {:>10}\n", "region", "vertices", "with curve",
                      "2 N/u [N/mm]", "depth [mm]");
  for (const auto& r : summary.regions)
    text += fmt::format("{:<10} {:>8} {:>10} {:>14.3f} {:>10.1f}\n", name(r.region), r.vertices,
                        r.with_curve, r.stiffness, r.depth);
  for (std::size_t s = 0; s < kVertexStatusNames.size(); ++s)
    if (const auto n = std::count(head.map.status.begin(), head.map.status.end(),
                                  static_cast<VertexStatus>(s)))
      text += fmt::format("{} {}: {} vertices\n", s == 0 ? "status" : "      ",
                          kVertexStatusNames[s], n);
  if (!head.completed.empty())
    text += fmt::format("a face alone: {} vertices rest on skin that was completed, not scanned\n",
                        std::count(head.completed.begin(), head.completed.end(), 1));
  text += published_text(head);
  if (summary.kendall_tau)
    text += fmt::format("Kendall tau against the published order: {:.2f}\n", *summary.kendall_tau);
  print_result(c, describe(head), text);
}

struct ExportOutputs {
  std::filesystem::path skull, csv, ply, vtp, tissue;
};

/// The skin's user vertices in mm, scan frame.
SurfaceMesh skin_mm(const TouchableHead& head) {
  return transformed(head.skin, head.unit_mm * Mat3::Identity(), Vec3::Zero());
}

/// The skin of a face alone, completed again as `palpate build` did: the file holds the face.
LocatedHead complete_again(const TouchableHead& head, const surface::WorkingSurface& working,
                           const Command& c, const Progress& progress) {
  PreparedScan scan;
  scan.file_name = c.input.filename().string();
  scan.scan.mesh = scan.scan_mm = skin_mm(head);
  scan.working = working;
  PipelineOptions options = c.options;
  for (const auto& [key, mark] : head.landmarks)  // those that the user gave
    if (mark.confidence == 1) options.landmarks.given[key] = mark.position;
  StageClock clock(progress);
  return locate_head(scan, options, progress, clock);
}

/// Tetrahedra anew from the head's own skin and skull.
TissueMesh rebuild_tissue(const TouchableHead& head, const Command& c, const Progress& progress) {
  const auto working = surface::make_working_surface(skin_mm(head), c.options.repair, progress);
  HeadFrame frame = head.frame;
  HeadSurface surface;
  if (head.completed.empty()) {
    surface.skin = transformed(working.mesh, frame.rotation, -(frame.rotation * frame.origin));
    surface.filled = working.filled;
    for (const auto& [key, mark] : head.landmarks)
      surface.landmarks[key] = {frame.to_head(mark.position), mark.confidence};
    surface.region = landmarks::skin_regions(surface.skin.points, vertex_normals(surface.skin),
                                             surface.landmarks);
  } else {
    LocatedHead located = complete_again(head, working, c, progress);
    frame = located.detection.frame;
    surface = std::move(located.head);
  }
  SkullFit skull;
  skull.mesh = transformed(head.skull, frame.rotation, -(frame.rotation * frame.origin));
  skull.region = head.skull_region;
  TissueMesh tissue = tetmesh::make_tissue_mesh(surface, skull, c.options.tissue, progress);
  for (Vec3& p : tissue.nodes) p = frame.to_scan(p);
  return tissue;
}

void run_export(Command& c, const ExportOutputs& out) {
  const std::vector<const std::filesystem::path*> all = {&out.skull, &out.csv, &out.ply, &out.vtp,
                                                         &out.tissue};
  bool any = false;
  for (const auto* path : all)
    if (!path->empty()) {
      check_writable(*path);
      any = true;
    }
  if (!any) throw InputError("export: name at least one of --skull --csv --ply --vtp --tissue");
  const TouchableHead head = io::read_head(c.input);
  const auto progress = make_terminal_progress(c.quiet);
  if (!out.skull.empty()) io::write_surface(out.skull, head.skull);
  if (!out.csv.empty()) io::write_map_csv(out.csv, head);
  if (!out.ply.empty()) io::write_map_ply(out.ply, head);
  if (!out.vtp.empty()) io::write_map_vtp(out.vtp, head);
  if (!out.tissue.empty()) io::write_tissue(out.tissue, rebuild_tissue(head, c, *progress));
  nlohmann::json written = nlohmann::json::array();
  std::string text;
  for (const auto* path : all)
    if (!path->empty()) {
      written.push_back(path->string());
      text += path->string() + "\n";
    }
  print_result(c, {{"written", written}}, text);
}

void run_report(Command& c) {
  check_writable(c.output);
  const TouchableHead head = io::read_head(c.input);
  const auto progress = make_terminal_progress(c.quiet);
  report::write_report(c.output, head, {}, *progress);
  print_result(c, {{"written", {c.output.string()}}}, c.output.string() + "\n");
}

}  // namespace

void add_head_commands(CLI::App& app) {
  auto c = std::make_shared<Command>();
  CLI::App* sub = add_subcommand(app, "inspect", "what a touchable head holds",
                                 "Example:  palpate inspect head.glb --json", c, run_inspect);
  add_head_argument(sub, c);

  c = std::make_shared<Command>();
  const auto out = std::make_shared<ExportOutputs>();
  sub = add_subcommand(app, "export", "touchable head -> files for other programs",
                       "Example:  palpate export head.glb --skull skull.ply --csv map.csv", c,
                       [out](Command& command) { run_export(command, *out); });
  add_head_argument(sub, c);
  sub->add_option("--skull", out->skull, "skull surface, scan frame, mm: .ply .obj .stl .off");
  sub->add_option("--csv", out->csv, "one row per vertex, with a JSON sidecar");
  sub->add_option("--ply", out->ply, "skin with the map as vertex properties");
  sub->add_option("--vtp", out->vtp, "skin with the map for ParaView");
  sub->add_option("--tissue", out->tissue, "tissue mesh, made anew: .vtu .veg .inp .msh");
  add_tissue_options(sub, c);

  c = std::make_shared<Command>();
  sub = add_subcommand(app, "report", "touchable head -> report page",
                       "Example:  palpate report head.glb -o head.report.html", c, run_report);
  add_head_argument(sub, c);
  add_output_option(sub, c, "report page, .html");
}

}  // namespace palpate::app
