// SPDX-License-Identifier: GPL-3.0-or-later
// Each stage alone, reading and writing standard files, so that a lab can replace any of them.
#include <fmt/format.h>

#include "apps/child_process.hpp"
#include "apps/command_line.hpp"
#include "apps/describe.hpp"
#include "apps/landmark_text.hpp"
#include "apps/survey.hpp"
#include "apps/terminal_progress.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "io/fit_file.hpp"
#include "registration/place.hpp"

namespace palpate::app {
using nlohmann::json;
namespace {

/// Scan and face: what most stages start from.
struct Start {
  std::unique_ptr<Progress> progress;
  StageClock clock;
  PreparedScan scan;
  LocatedHead located;

  explicit Start(Command& c) : Start(c, make_terminal_progress(c.quiet)) {}
  Start(Command& c, std::unique_ptr<Progress> shown)
      : progress(std::move(shown)),
        clock(*progress),
        scan(prepare_scan(c.input, c.options, *progress, clock)),
        located(locate_head(scan, c.options, *progress, clock)) {}
};

void run_repair(Command& c) {
  check_writable(c.output);
  const auto progress = make_terminal_progress(c.quiet);
  StageClock clock(*progress);
  const PreparedScan scan = prepare_scan(c.input, c.options, *progress, clock);
  io::write_surface(c.output, scan.working.mesh);
  std::string text = fmt::format("unit {}\n", name(scan.unit));
  for (const std::string& line : scan.working.report.lines) text += line + "\n";
  print_result(c, {{"unit_mm", millimetres(scan.unit)}, {"repair", describe(scan.working.report)}},
               text);
}

void run_landmarks(Command& c, const std::filesystem::path& edit) {
  if (!c.output.empty()) check_writable(c.output);
  if (!edit.empty()) {
    check_writable(edit);
    if (std::filesystem::exists(edit))
      for (const auto& [key, p] : parse_landmark_text(read_file(edit), edit.string()))
        c.options.landmarks.given.try_emplace(key, p);  // --landmark wins
  }
  const Start start(c);
  const double unit_mm = millimetres(start.scan.unit);
  const json result = {{"unit_mm", unit_mm},
                       {"landmarks", describe(start.located.detection.landmarks, unit_mm)},
                       {"frame", describe(start.located.detection.frame)},
                       {"warnings", start.located.detection.warnings}};
  if (!c.output.empty()) write_file(c.output, result.dump(2) + "\n");
  if (!edit.empty()) write_file(edit, landmark_text(start.located.detection.landmarks, unit_mm));
  std::string text =
      fmt::format("unit {}; positions in the scan's own coordinates\n", name(start.scan.unit));
  for (const auto& [key, mark] : start.located.detection.landmarks)
    text += fmt::format("{:<20} {:12.4f} {:12.4f} {:12.4f}   confidence {:.2f}\n", key,
                        mark.position.x() / unit_mm, mark.position.y() / unit_mm,
                        mark.position.z() / unit_mm, mark.confidence);
  for (const std::string& warning : start.located.detection.warnings)
    text += "warning: " + warning + "\n";
  print_result(c, result, text);
}

void run_place(Command& c) {
  check_writable(c.output);
  const Start start(c);
  const SkullTemplate skull = load_template(c.options);
  const auto placed = c.fit_method == "published"
                          ? registration::place_published(start.located.head, skull)
                          : registration::place_similarity(start.located.head, skull);
  const HeadFrame& frame = start.located.detection.frame;
  SurfaceMesh mesh = transformed(skull.mesh, placed.linear, placed.translation);
  mesh = transformed(mesh, frame.rotation.transpose(), frame.origin);
  io::write_surface(c.output, mesh);
  print_result(c, {{"residuals_mm", placed.residuals_mm}},
               fmt::format("skull template placed: {} (scan frame, mm)\n", c.output.string()));
}

/// The skin that the skull was fitted into, in the scan's frame, with what each point is.
void write_skin(const std::filesystem::path& path, const LocatedHead& located) {
  const HeadFrame& frame = located.detection.frame;
  const std::vector<double> filled(located.head.filled.begin(), located.head.filled.end());
  io::write_columns_ply(path,
                        transformed(located.head.skin, frame.rotation.transpose(), frame.origin),
                        {{"filled", filled}});
}

struct FitOutputs {
  std::filesystem::path skin;
  int page = 0;  ///< process of the page that runs this; 0: none
};

/// Skull alone, or, as .glb, with what it means for each vertex.
void write_skull(const Command& c, const Start& start, const SkullFit& skull,
                 const std::vector<std::string>& warnings) {
  const std::filesystem::path& path = c.output;
  const LocatedHead& located = start.located;
  const HeadFrame& frame = located.detection.frame;
  const SurfaceMesh mesh = transformed(skull.mesh, frame.rotation.transpose(), frame.origin);
  if (path.extension() == ".glb")
    io::write_fit(path, {mesh, depth_below(located, skull, c.options, *start.progress),
                         located.region, located.detection.landmarks, warnings});
  else
    io::write_surface(path, mesh);
}

void run_fit(Command& c, const FitOutputs& outputs) {
  const std::filesystem::path& skin = outputs.skin;
  check_writable(c.output);
  if (!skin.empty()) check_writable(skin);
  if (outputs.page > 0) serve_in_background(outputs.page);
  Start start(c, outputs.page > 0 ? make_line_progress() : make_terminal_progress(c.quiet));
  if (!skin.empty()) write_skin(skin, start.located);
  const SkullFit skull = make_skull(start.located, c.options, *start.progress, start.clock);
  std::string text;
  for (const DepthRow& d : skull.depths)
    if (d.reached)
      text += fmt::format("{:<12} depth {:5.1f} mm, published {:5.1f}\n", d.code, d.depth_mm,
                          d.published_mm);
  if (const auto jaw = skull.statistics.find("jaw_opening_deg"); jaw != skull.statistics.end())
    text += fmt::format("jaw opened by {:.1f} degrees (SD {:.1f})\n", jaw->second,
                        skull.statistics.at("jaw_opening_sd_deg"));
  std::vector<std::string> warnings = start.located.detection.warnings;
  warnings.insert(warnings.end(), skull.warnings.begin(), skull.warnings.end());
  write_skull(c, start, skull, warnings);
  for (const std::string& warning : warnings) text += "warning: " + warning + "\n";
  print_result(
      c, {{"depths", describe(skull.depths)}, {"fit", skull.statistics}, {"warnings", warnings}},
      text + fmt::format("skull {} (scan frame, mm)\n", c.output.string()));
}

void run_mesh(Command& c) {
  check_writable(c.output);
  Start start(c);
  const SkullFit skull = make_skull(start.located, c.options, *start.progress, start.clock);
  TissueMesh tissue = start.clock.run("tissue", [&] {
    return tetmesh::make_tissue_mesh(start.located.head, skull, c.options.tissue, *start.progress);
  });
  for (Vec3& p : tissue.nodes) p = start.located.detection.frame.to_scan(p);
  io::write_tissue(c.output, tissue);
  print_result(c, {{"tissue_mesh", tissue.quality}},
               fmt::format("{} tetrahedra, {} nodes: {} (scan frame, mm)\n", tissue.tets.size(),
                           tissue.nodes.size(), c.output.string()));
}

}  // namespace

void add_stage_commands(CLI::App& app) {
  auto c = std::make_shared<Command>();
  CLI::App* sub = add_subcommand(app, "repair", "scan -> closed, even working surface",
                                 "Example:  palpate repair scan.obj -o working.ply", c, run_repair);
  add_scan_options(sub, c);
  add_output_option(sub, c, "working surface in mm: .ply .obj .stl .off");

  c = std::make_shared<Command>();
  const auto edit = std::make_shared<std::filesystem::path>();
  sub = add_subcommand(app, "landmarks", "scan -> the face's named points",
                       "Examples:\n  palpate landmarks scan.obj --json > landmarks.json\n"
                       "  palpate landmarks scan.obj --edit points.txt   # move points, run again",
                       c, [edit](Command& command) { run_landmarks(command, *edit); });
  sub->add_option("--edit", *edit,
                  "text file with one point a line: written; read first where it is there, and its "
                  "lines that say \"fixed\" hold");
  add_scan_options(sub, c);
  add_landmark_options(sub, c);
  sub->add_option("-o,--output", c->output, "also write them to a JSON file");

  c = std::make_shared<Command>();
  sub = add_subcommand(app, "place", "scan -> skull template placed by five points",
                       "Example:  palpate place scan.obj -o placed.ply", c, run_place);
  add_scan_options(sub, c);
  add_landmark_options(sub, c);
  add_fit_options(sub, c);
  add_output_option(sub, c, "placed skull: .ply .obj .stl .off");

  c = std::make_shared<Command>();
  const auto outputs = std::make_shared<FitOutputs>();
  sub = add_subcommand(app, "fit", "scan -> skull fitted under the skin",
                       "Examples:\n  palpate fit scan.obj -o skull.ply\n"
                       "  palpate fit scan.obj -o fit.glb   # with the depth at each vertex",
                       c, [outputs](Command& command) { run_fit(command, *outputs); });
  sub->add_option("--page", outputs->page, "")->group("");  // how the page's server runs it
  sub->add_option(
      "--skin", outputs->skin,
      "also write the closed skin, .ply; `filled` per vertex: 0 scanned, 1 closed hole, "
      "2 completed from another head (a face alone)");
  add_scan_options(sub, c);
  add_landmark_options(sub, c);
  add_fit_options(sub, c);
  add_output_option(sub, c,
                    "fitted skull: .ply .obj .stl .off; .glb: with depth and region per vertex");

  c = std::make_shared<Command>();
  sub = add_subcommand(app, "mesh", "scan and skull -> tetrahedra of flesh and bone",
                       "Example:  palpate mesh scan.obj --skull skull.ply -o tissue.vtu", c,
                       run_mesh);
  add_scan_options(sub, c);
  add_landmark_options(sub, c);
  add_fit_options(sub, c);
  add_own_skull(sub, c);
  add_tissue_options(sub, c);
  add_output_option(sub, c, "tissue mesh: .vtu .veg .inp .msh");
}

}  // namespace palpate::app
