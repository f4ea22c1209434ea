// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate compare`: an estimated head beside one whose skull is known.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "apps/command_line.hpp"
#include "apps/terminal_progress.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "io/head_file.hpp"
#include "report/comparison.hpp"

namespace palpate::app {
namespace {

struct CompareOptions {
  std::filesystem::path known, html, csv, ply;
  std::vector<std::string> leave_out;
};

/// "x0,x1,y0,y1,z0,z1", scan frame, mm.
Box parse_box(const std::string& words) {
  std::array<double, 6> x{};
  const char* at = words.c_str();
  for (std::size_t i = 0; i < x.size(); ++i) {
    char* end = nullptr;
    x[i] = std::strtod(at, &end);
    if (end == at || *end != (i + 1 < x.size() ? ',' : '\0') || std::isnan(x[i]))
      throw InputError(fmt::format(
          "--leave-out {}: six numbers x0,x1,y0,y1,z0,z1 in mm are wanted, without spaces", words));
    at = end + 1;
  }
  return {{x[0], x[2], x[4]}, {x[1], x[3], x[5]}};
}

std::string text_of(const report::Comparison& c) {
  std::string text = fmt::format("{:<10} {:>8} {:>12} {:>10} {:>14} {:>11}\n", "region", "vertices",
                                 "depth [mm]", "bias [mm]", "stiffness [%]", "in 2 SD [%]");
  const auto line = [&](std::string_view name, const report::RegionComparison& r) {
    text +=
        fmt::format("{:<10} {:>8} {:>12.2f} {:>10.2f} {:>14.1f} {:>11.1f}\n", name, r.vertices,
                    r.depth_error, r.depth_bias, 100 * r.stiffness_error, 100 * r.within_two_sd);
  };
  for (const report::RegionComparison& r : c.regions) line(name(r.region), r);
  line("all", c.all);
  return text +
         fmt::format("depth over the face {:.2f} mm off; the best constant depth {:.2f} mm\n",
                     c.face_error, c.face_constant_error);
}

void run_compare(Command& c, const CompareOptions& o) {
  for (const auto* path : {&o.html, &o.csv, &o.ply})
    if (!path->empty()) check_writable(*path);
  report::ComparisonOptions options;
  for (const std::string& words : o.leave_out) options.leave_out.push_back(parse_box(words));
  const TouchableHead estimated = io::read_head(c.input), known = io::read_head(o.known);
  const report::Comparison comparison = report::compare_heads(estimated, known, options);
  const auto progress = make_terminal_progress(c.quiet);
  if (!o.html.empty()) report::write_comparison(o.html, estimated, comparison, *progress);
  const std::vector<io::Column> columns = {{"depth_difference_mm", comparison.depth},
                                           {"stiffness_difference", comparison.stiffness},
                                           {"depth_sd_mm", estimated.spread.depth}};
  const SurfaceMesh skin =
      transformed(estimated.skin, estimated.unit_mm * Mat3::Identity(), Vec3::Zero());
  if (!o.csv.empty()) io::write_columns_csv(o.csv, skin, columns);
  if (!o.ply.empty()) io::write_columns_ply(o.ply, skin, columns);
  print_result(c, report::to_json(comparison), text_of(comparison));
}

}  // namespace

void add_compare_command(CLI::App& app) {
  const auto c = std::make_shared<Command>();
  const auto o = std::make_shared<CompareOptions>();
  CLI::App* sub = add_subcommand(
      app, "compare", "estimated head against one whose skull is known: depth and stiffness",
      "Example:  palpate compare estimated.glb true.glb --html differences.html", c,
      [o](Command& command) { run_compare(command, *o); });
  sub->add_option("ESTIMATED", c->input, "touchable head whose skull was fitted, .glb")->required();
  sub->add_option("TRUE", o->known, "the same scan with its measured skull, .glb")->required();
  sub->add_option("--leave-out", o->leave_out,
                  "box x0,x1,y0,y1,z0,z1 in mm, scan frame, that is not compared; may repeat");
  sub->add_option("--html", o->html, "page with figures by region and maps of the differences");
  sub->add_option("--csv", o->csv, "one row per vertex");
  sub->add_option("--ply", o->ply, "skin with the differences as vertex properties");
}

}  // namespace palpate::app
