// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate sweep` and `palpate merge`: the curves of a head, in one run or in shards.
#include <fmt/format.h>

#include "apps/command_line.hpp"
#include "apps/describe.hpp"
#include "apps/terminal_progress.hpp"
#include "core/error.hpp"
#include "io/head_file.hpp"

namespace palpate::app {
namespace {

void run_sweep(Command& c) {
  const bool shard = c.options.sweep.shard_count > 1;
  if (shard && c.options.sweep.checkpoint.empty())
    throw InputError("--shard: name the shard's file with --checkpoint");
  if (!shard && c.output.empty()) throw InputError("--output is required (or --shard)");
  if (shard && !c.output.empty())
    throw InputError("--shard: makes no head; leave --output out and use `palpate merge`");
  if (!shard) check_writable(c.output);
  const auto progress = make_terminal_progress(c.quiet);
  StageClock clock(*progress);
  PreparedScan scan = prepare_scan(c.input, c.options, *progress, clock);
  const LocatedHead located = locate_head(scan, c.options, *progress, clock);
  const SkullFit skull = make_skull(located, c.options, *progress, clock);
  const MappedHead mapped = make_map(located, skull, c.options, *progress, clock);
  for (const std::string& note : mapped.sweep.notes) fmt::print(stderr, "palpate: {}\n", note);
  if (shard) {
    print_result(c, {{"sweep", mapped.sweep.statistics}, {"seconds", clock.seconds()}},
                 fmt::format("shard {}: {:.0f} curves in {}\n", c.shard,
                             mapped.sweep.statistics.at("curves_in_store"),
                             c.options.sweep.checkpoint.string()));
    return;
  }
  std::vector<std::string> warnings = skull.warnings;
  warnings.insert(warnings.end(), mapped.sweep.warnings.begin(), mapped.sweep.warnings.end());
  TouchableHead head = assemble(scan, located, skull, mapped, std::nullopt, c.options, warnings);
  head.run = {{"seconds", clock.seconds()}, {"threads", c.threads}};
  io::write_head(c.output, head);
  print_result(c, describe(head), fmt::format("head {}\n", c.output.string()));
}

void add_job_options(CLI::App* sub, const CommandPtr& c) {
  add_scan_options(sub, c);
  add_landmark_options(sub, c);
  add_fit_options(sub, c);
  add_own_skull(sub, c);
  add_tissue_options(sub, c);
  add_sweep_options(sub, c);
}

}  // namespace

void add_sweep_commands(CLI::App& app) {
  auto c = std::make_shared<Command>();
  CLI::App* sub =
      add_subcommand(app, "sweep", "scan and skull -> force-depth curves (head.glb without report)",
                     "Examples:\n  palpate sweep scan.obj --skull skull.ply -o head.glb\n"
                     "  palpate sweep scan.obj --mode exact --checkpoint scan.sweep -o head.glb\n"
                     "  palpate sweep scan.obj --mode exact --shard 2/4 --checkpoint part2.sweep\n"
                     "  palpate sweep scan.obj --preset published --sites 20 -o thesis.glb",
                     c, run_sweep);
  add_job_options(sub, c);
  sub->add_option("-o,--output", c->output, "touchable head, .glb");
  sub->add_option("--shard", c->shard,
                  "i/n: solve the i-th of n parts into --checkpoint; see `palpate merge`");

  c = std::make_shared<Command>();
  sub = add_subcommand(app, "merge",
                       "scan and the parts of all shards -> head.glb, as one run would make it",
                       "Example, with the options that the shards were given:\n"
                       "  palpate merge scan.obj part1.sweep part2.sweep --mode exact -o head.glb",
                       c, run_sweep);
  add_job_options(sub, c);
  sub->add_option("PART", c->options.sweep.parts, "checkpoint files of the shards")
      ->required()
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_output_option(sub, c, "touchable head, .glb");
}

}  // namespace palpate::app
