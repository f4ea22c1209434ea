// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate build`: from a scan to a touchable head and its report.
#include <fmt/format.h>

#include <cmath>

#include "apps/command_line.hpp"
#include "apps/describe.hpp"
#include "apps/terminal_progress.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "io/head_file.hpp"
#include "report/report.hpp"
#include "report/summary.hpp"

namespace palpate::app {
namespace fs = std::filesystem;
namespace {

struct BuildOutputs {
  fs::path report;
  fs::path tissue;
  bool no_report = false;
  bool no_tissue = false;
};

fs::path default_report(const fs::path& head) {
  return head.parent_path() / (head.stem().string() + ".report.html");
}

std::vector<std::string> collect_warnings(const PreparedScan& scan, const LocatedHead& located,
                                          const SkullFit& skull, const stiffness::Sweep& sweep) {
  std::vector<std::string> all;
  if (!scan.unit_certain)
    all.push_back(fmt::format(
        "the unit was guessed as {}, but another fits too; give --unit if this is wrong",
        name(scan.unit)));
  const auto add = [&all](const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add(scan.scan.warnings);
  add(located.detection.warnings);
  add(skull.warnings);
  add(sweep.warnings);
  return all;
}

/// The volume mesh serves exports and statistics; the curves do not depend on it, so a mesher that
/// fails costs a warning, not the head.
std::optional<TissueMesh> mesh_tissue(const LocatedHead& located, const SkullFit& skull,
                                      const PipelineOptions& options, const Progress& progress,
                                      StageClock& clock, std::vector<std::string>& warnings) {
  try {
    return clock.run("tissue", [&] {
      return tetmesh::make_tissue_mesh(located.head, skull, options.tissue, progress);
    });
  } catch (const InputError& error) {
    warnings.push_back(fmt::format("no tissue mesh: {}", error.what()));
  } catch (const SolveError& error) {
    warnings.push_back(fmt::format("no tissue mesh: {}", error.what()));
  }
  return std::nullopt;
}

std::string summary_text(const TouchableHead& head, const Command& command,
                         const BuildOutputs& outputs) {
  const report::RegionSummary summary = report::region_summary(head);
  std::string text =
      fmt::format("unit {} ({})\n", head.provenance["input"]["unit"].get<std::string>(),
                  command.options.unit.empty() ? "guessed from the size" : "given");
  if (head.provenance.contains("image"))
    for (const auto& line : head.provenance["image"])
      text += fmt::format("image: {}\n", line.get<std::string>());
  for (const auto& line : head.provenance["repair"]["lines"])
    text += fmt::format("repair: {}\n", line.get<std::string>());
  for (const auto& line : head.provenance["warnings"])
    text += fmt::format("warning: {}\n", line.get<std::string>());
  text += summary.order.empty() ? "stiffness at 2 N: no region has curves"
                                : "stiffness at 2 N [N/mm], stiff to soft:";
  for (const SkinRegion r : summary.order)
    for (const auto& f : summary.regions)
      if (f.region == r) text += fmt::format(" {} {:.2f}", name(r), f.stiffness);
  text += "\n";
  if (summary.kendall_tau)
    text +=
        fmt::format("order against the published one: Kendall tau {:.2f}\n", *summary.kendall_tau);
  text += fmt::format("head   {}\n", command.output.string());
  if (!outputs.no_report) text += fmt::format("report {}\n", outputs.report.string());
  return text;
}

bool is_image(const PipelineOptions& options) {
  return !options.ct.empty() || !options.labels.empty();
}

void check_input(const Command& command) {
  const PipelineOptions& o = command.options;
  const int given = !command.input.empty() + !o.ct.empty() + !o.labels.empty();
  if (given != 1)
    throw InputError("build: give one of SCAN, --ct and --labels (try palpate build --help)");
  if (is_image(o) && !o.own_skull.empty())
    throw InputError("build: --skull goes with a SCAN; an image brings its own skull");
}

void add_image_options(CLI::App* sub, PipelineOptions& o) {
  sub->add_option(
      "--ct", o.ct,
      "CT instead of SCAN: .nii .nii.gz .nrrd .nhdr or a DICOM folder; its skull is used as it is");
  sub->add_option("--labels", o.labels,
                  "tissue labels instead of SCAN, as SimNIBS writes them: .nii .nii.gz .nrrd");
  sub->add_option("--skin-threshold", o.image.skin_threshold, "[HU] --ct: above is tissue")
      ->capture_default_str();
  sub->add_option("--bone-threshold", o.image.bone_threshold, "[HU] --ct: above is bone")
      ->capture_default_str();
  sub->add_option("--bone-labels", o.image.bone_labels, "--labels: which are bone")
      ->delimiter(',')
      ->capture_default_str();
  sub->add_option("--image-smoothing", o.image.smoothing, "[mm] Gaussian before the threshold")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  sub->add_option("--image-voxel", o.image.voxel, "[mm] finer images are thinned out to this")
      ->check(CLI::Range(0.2, 10.0))
      ->capture_default_str();
}

void run_build(Command& command, BuildOutputs outputs) {
  check_input(command);
  if (outputs.report.empty()) outputs.report = default_report(command.output);
  check_writable(command.output);
  if (!outputs.no_report) check_writable(outputs.report);
  if (!outputs.tissue.empty()) check_writable(outputs.tissue);
  const auto progress = make_terminal_progress(command.quiet);
  StageClock clock(*progress);
  const PipelineOptions& options = command.options;

  PreparedScan scan = is_image(options) ? prepare_image(options, *progress, clock)
                                        : prepare_scan(command.input, options, *progress, clock);
  const LocatedHead located = locate_head(scan, options, *progress, clock);
  const SkullFit skull = make_skull(located, options, *progress, clock);
  std::vector<std::string> tissue_warnings;
  std::optional<TissueMesh> tissue;
  if (!outputs.no_tissue)
    tissue = mesh_tissue(located, skull, options, *progress, clock, tissue_warnings);
  const MappedHead mapped = make_map(located, skull, options, *progress, clock);

  std::vector<std::string> warnings = collect_warnings(scan, located, skull, mapped.sweep);
  warnings.insert(warnings.end(), tissue_warnings.begin(), tissue_warnings.end());
  TouchableHead head = assemble(scan, located, skull, mapped, tissue, options, warnings);
  head.run = {{"seconds", clock.seconds()}, {"threads", command.threads}};

  if (tissue && !outputs.tissue.empty()) io::write_tissue(outputs.tissue, *tissue);
  if (!outputs.no_report) {
    clock.run("report", [&] {
      report::write_report(outputs.report, head, {}, *progress);
      return 0;
    });
    head.run["seconds"] = clock.seconds();
  }
  io::write_head(command.output, head);
  print_result(command, describe(head), summary_text(head, command, outputs));
}

}  // namespace

void add_build_command(CLI::App& app) {
  const auto command = std::make_shared<Command>();
  const auto outputs = std::make_shared<BuildOutputs>();
  CLI::App* sub = add_subcommand(
      app, "build", "scan -> touchable head (.glb) and report",
      "Examples:\n  palpate build scan.obj -o head.glb\n"
      "  palpate build scan.ply -o head.glb --unit m --landmark nose_tip=0.1,12.5,93\n"
      "  palpate build scan.stl -o head.glb --config lab.toml\n"
      "  palpate build --ct head.nii.gz -o head.glb\n"
      "  palpate build scan.obj -o thesis.glb --preset published   # the thesis' own press",
      command, [outputs](Command& c) { run_build(c, *outputs); });
  add_scan_options(sub, command);
  sub->get_option("SCAN")->required(false);
  add_image_options(sub, command->options);
  add_output_option(sub, command, "the touchable head, .glb");
  sub->add_option("--report", outputs->report,
                  "report page; default: beside the head, .report.html");
  sub->add_flag("--no-report", outputs->no_report, "write no report page");
  sub->add_option("--tissue", outputs->tissue, "also write the tissue mesh: .vtu .veg .inp .msh");
  sub->add_flag("--no-tissue", outputs->no_tissue,
                "make no tissue mesh (the curves do not need it)");
  add_landmark_options(sub, command);
  add_fit_options(sub, command);
  sub->add_option("--skull", command->options.own_skull,
                  "your own skull instead of a fit: scan frame, mm");
  add_tissue_options(sub, command);
  add_sweep_options(sub, command);
}

}  // namespace palpate::app
