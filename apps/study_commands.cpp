// SPDX-License-Identifier: GPL-3.0-or-later
// palpate study: run, check, withdraw, upgrade.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "apps/command_line.hpp"
#include "apps/study_session.hpp"
#include "apps/terminal_progress.hpp"
#include "core/error.hpp"
#include "study/store.hpp"

namespace palpate::app {
namespace {

using nlohmann::json;
using study::Store;

void run_study(const Command& c, StudyOptions& o) {
  o.protocol = c.input;
  o.output = c.output;
  o.simulation.seed = o.seed ? o.seed : 1;
  if (o.simulate && o.seed == 0) o.seed = 1;
  (void)study::simulation_json(o.simulation);
  if (!std::filesystem::exists(o.output)) check_writable(o.output);
  const auto stop = make_terminal_progress(c.quiet || c.json || o.follow || !o.simulate);
  const auto say = [&](const std::string& line) {
    // The address is wanted by scripts too, and with it each line that was asked for.
    const bool address = line.starts_with("participant ") || line.starts_with("experimenter ");
    if (c.json && address)
      fmt::print("{}\n",
                 json{{line.substr(0, line.find(' ')), line.substr(line.find(' ') + 1)}}.dump());
    else if (o.follow || !c.quiet)
      fmt::print(c.json && !o.follow ? stderr : stdout, "{}\n", line);
    std::fflush(stdout);
  };
  OpenStudy study = open_study(o);
  const json result =
      o.simulate ? run_simulated(study, o, *stop, say) : run_live(study, o, *stop, say);
  std::string text;
  if (o.simulate)
    text = fmt::format(
        "{}: {} simulated participants, {} finished, {} excused, {} haptic samples in {:.1f} s\n",
        o.output.string(), result["participants"].get<int>(), result["finished"].get<int>(),
        result["excused"].get<int>(), result["samples"].get<std::size_t>(),
        result["seconds"].get<double>());
  print_result(c, result, text);
}

void add_run(CLI::App& group) {
  auto c = std::make_shared<Command>();
  auto o = std::make_shared<StudyOptions>();
  CLI::App* sub = add_subcommand(
      group, "run", "run a study: pages for experimenter and participant, device, file",
      "Examples:\n"
      "  palpate study run protocols/head-stiffness-2015.toml head.glb -o study.db\n"
      "  palpate study run protocols/head-stiffness-2015.toml head.glb -o trial.db --simulate "
      "--participants 25\n"
      "The same command goes on with a study that was stopped. Ctrl-C ends it.",
      c, [o](Command& command) { run_study(command, *o); });
  sub->add_option("PROTOCOL", c->input, "protocol, .toml; see docs/study.md")->required();
  sub->add_option("HEAD", o->head, "touchable head, .glb, as `palpate build` writes it")
      ->required();
  add_output_option(sub, c, "study file; one that is there is gone on with");
  sub->add_option("--participants", o->participants, "planned; default: the protocol's")
      ->check(CLI::Range(1, 9999));
  sub->add_option("--seed", o->seed, "of all orders; default: drawn, 1 with --simulate")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62U));
  sub->add_flag("--simulate", o->simulate, "simulated participants, at the machine's speed");
  sub->add_option("--weber", o->simulation.weber,
                  "[-] difference of stiffness that a simulated participant tells in 3 of 4 cases")
      ->check(CLI::Range(0.001, 2.0))
      ->capture_default_str();
  sub->add_option("--rating-noise", o->simulation.rating_noise,
                  "standard deviation of a simulated rating beyond what was felt")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  sub->add_flag("--follow", o->follow, "print each answer as it is committed, as JSON");
  sub->add_option("--device", o->device,
                  "auto, simulated[:falcon], force-dimension[:n], inverse3[:id], touch[:name]")
      ->capture_default_str();
  sub->add_option("--rate", o->rate_hz, "[Hz] of the loop")
      ->check(CLI::Range(100.0, 4000.0))
      ->capture_default_str();
  sub->add_option("--priority", o->priority, "real-time priority, 1 to 99; 0 asks for none")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  sub->add_option("--port", o->port, "port of the pages; 0: a free one")
      ->check(CLI::Range(0, 65535));
  sub->add_option("--listen", o->address,
                  "numeric address to serve at; beyond 127.0.0.1 a token guards the pages")
      ->capture_default_str();
  sub->add_option(
      "--token", o->token,
      "secret in the pages' address, 8 or more letters, digits, - and _; made up where needed");
  bool* const open = &o->open_browser;
  sub->add_flag_function(
      "--no-open", [open](std::int64_t) { *open = false; }, "do not open a browser");
  sub->add_option("--seconds", o->seconds, "[s] end by itself; 0: at Ctrl-C")
      ->check(CLI::Range(0.0, 86400.0));
}

void run_check(const Command& c) {
  const auto findings = study::check_store(c.input);
  const Store store = Store::open(c.input, Store::Access::read);
  const study::Study s = store.study();
  const auto people = store.participants();
  std::map<std::string, int> states;
  for (const auto& p : people) ++states[std::string(name(p.state))];
  std::size_t samples = 0;
  for (const auto& b : store.block_summaries()) samples += b.count;
  std::string text = fmt::format("{}{}: {} on {}, {} participants", s.simulated ? "SIMULATED " : "",
                                 c.input.string(), s.protocol_name, s.head_name, people.size());
  for (const auto& [state, count] : states) text += fmt::format(", {} {}", count, state);
  text += fmt::format("; {} answers, {} samples\n", store.answers().size(), samples);
  for (const std::string& f : findings) text += "  " + f + "\n";
  text += findings.empty() ? "nothing is wrong with it\n" : "";
  print_result(c,
               {{"study", c.input.string()},
                {"simulated", s.simulated},
                {"participants", states},
                {"answers", store.answers().size()},
                {"samples", samples},
                {"findings", findings}},
               text);
  if (!findings.empty())
    throw InputError(fmt::format("{}: {} findings; the study is not as it was recorded",
                                 c.input.string(), findings.size()));
}

void run_withdraw(const Command& c, const std::string& who) {
  const auto people = Store::open(c.input, Store::Access::read).participants();
  if (std::none_of(people.begin(), people.end(), [&](auto& p) { return p.pseudonym == who; }))
    throw InputError(fmt::format("{}: there is no participant {}", c.input.string(), who));
  Store store = Store::open(c.input, Store::Access::run);
  store.withdraw(who);
  print_result(c, {{"withdrawn", who}},
               fmt::format("{}: everything that came from {} is deleted\n", c.input.string(), who));
}

void run_upgrade(const Command& c) {
  { (void)Store::open(c.input, Store::Access::run); }
  print_result(c, {{"format", study::kStoreVersion}},
               fmt::format("{}: study format {}\n", c.input.string(), study::kStoreVersion));
}

void add_small(CLI::App& group) {
  constexpr const char* kStudy = "study file of `palpate study run`";
  auto c = std::make_shared<Command>();
  CLI::App* sub = add_subcommand(group, "check", "is a study file as it was recorded?",
                                 "Example:  palpate study check study.db\n"
                                 "Exit code 2 where something is wrong; the file is not changed.",
                                 c, [](Command& command) { run_check(command); });
  sub->add_option("STUDY", c->input, kStudy)->required();

  c = std::make_shared<Command>();
  auto who = std::make_shared<std::string>();
  sub = add_subcommand(group, "withdraw", "delete everything that came from a participant",
                       "Example:  palpate study withdraw study.db P007\n"
                       "The pseudonym and the time of the withdrawal stay. There is no way back.",
                       c, [who](Command& command) { run_withdraw(command, *who); });
  sub->add_option("STUDY", c->input, kStudy)->required();
  sub->add_option("PSEUDONYM", *who, "P001, P002, ...")->required();

  c = std::make_shared<Command>();
  sub = add_subcommand(group, "upgrade", "bring an older study file to the present format",
                       "Example:  palpate study upgrade study.db", c,
                       [](Command& command) { run_upgrade(command); });
  sub->add_option("STUDY", c->input, kStudy)->required();
}

}  // namespace

void add_study_commands(CLI::App& app) {
  CLI::App* group = app.add_subcommand("study", "run a study of a head, check it, analyse it");
  group->require_subcommand(1);
  group->footer(
      "Start with:  palpate study run protocols/head-stiffness-2015.toml head.glb -o study.db\n"
      "then:        palpate study check study.db; palpate study analyse study.db -o results");
  add_run(*group);
  add_small(*group);
}

}  // namespace palpate::app
