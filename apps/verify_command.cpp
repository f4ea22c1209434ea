// SPDX-License-Identifier: GPL-3.0-or-later
// palpate verify: the mechanics checked on this machine.
#include <fmt/format.h>

#include "apps/command_line.hpp"
#include "apps/terminal_progress.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/assets.hpp"
#include "verify/verify.hpp"

namespace palpate::app {
namespace {

nlohmann::json described(const std::vector<verify::Section>& sections) {
  nlohmann::json out = nlohmann::json::array();
  for (const verify::Section& s : sections)
    for (const verify::Figure& f : s.figures) {
      nlohmann::json one = {{"section", s.id},
                            {"figure", f.what},
                            {"limit", f.limit},
                            {"bound", f.at_least ? "at_least" : "at_most"},
                            {"verdict", verify::name(f.verdict)},
                            {"note", f.note}};
      if (f.verdict != verify::Verdict::not_run) one["measured"] = f.value;
      out.push_back(std::move(one));
    }
  return out;
}

void run_verify(Command& c, const verify::VerifyOptions& options) {
  if (!c.output.empty()) check_writable(c.output);
  const auto progress = make_terminal_progress(c.quiet);
  const auto sections = verify::run_verification(options, *progress);
  if (!c.output.empty()) write_file(c.output, verify::html_page(sections));
  print_result(c, {{"figures", described(sections)}, {"all_met", verify::all_met(sections)}},
               verify::text_table(sections));
  if (!verify::all_met(sections)) throw SolveError("a figure was missed; see the table");
}

}  // namespace

void add_verify_command(CLI::App& app) {
  const auto c = std::make_shared<Command>();
  const auto options = std::make_shared<verify::VerifyOptions>();
  CLI::App* sub = add_subcommand(
      app, "verify", "check the mechanics against exact solutions, GetFEM and CalculiX",
      "Example:  palpate verify -o verification.html\n"
      "Exit code 3 where a figure is missed. A comparison whose program is not installed is left "
      "out and named (Debian: python3-getfem, calculix-ccx).",
      c, [options](Command& command) {
        options->exact_layer_csv = io::data_folder() / "bonded_layer_indentation.csv";
        run_verify(command, *options);
      });
  sub->add_option("-o,--output", c->output, "page to write: tables and plots in one file")
      ->type_name("PAGE.html");
  sub->add_flag("--quick", options->quick,
                "fewer states, rows and loads: a minute, not half an hour");
  sub->add_option("--only", options->only,
                  "sections to run: " + fmt::format("{}", fmt::join(verify::section_ids(), ", ")))
      ->type_name("ID");
}

}  // namespace palpate::app
