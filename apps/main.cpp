// SPDX-License-Identifier: GPL-3.0-or-later
// palpate: the command line. Errors become one line on standard error and an exit code.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <new>
#include <set>

#include "apps/command_line.hpp"
#include "apps/config_file.hpp"
#include "core/error.hpp"
#include "core/version.hpp"

namespace palpate::app {
namespace {

/// Replaces `--config FILE` by the words of the file, right after the subcommand, so that what the
/// user typed comes later and wins.
std::vector<std::string> expand_config(CLI::App& app, std::vector<std::string> words) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    const bool joined = words[i].starts_with("--config=");
    if (!joined && (words[i] != "--config" || i + 1 >= words.size())) continue;
    const std::string file = joined ? words[i].substr(9) : words[i + 1];
    const auto subs =
        app.get_subcommands([&](const CLI::App* one) { return one->get_name() == words.front(); });
    if (subs.empty()) return words;
    const CLI::App* sub = subs.front();
    std::ptrdiff_t after = 1;
    for (const CLI::App* nested : sub->get_subcommands({}))  // "study run"
      if (words.size() > 1 && nested->get_name() == words[1]) {
        sub = nested;
        after = 2;
        break;
      }
    std::set<std::string> known;
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames())
        if (name != "config" && name != "help") known.insert(name);
    const auto from_file = read_config(file, known);
    words.insert(words.begin() + after, from_file.begin(), from_file.end());
    return words;
  }
  return words;
}

std::string worded(const std::exception& error) {
  std::string line = error.what();
  for (char& c : line)
    if (c == '\n' || c == '\r') c = ' ';
  return line;
}

/// At a terminal a line of progress or the "^C" of the keyboard may stand where the message goes.
void say(const std::exception& error) {
  const char* clear = isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "";
  fmt::print(stderr, "{}palpate: {}\n", clear, worded(error));
}

int run(int argc, char** argv) {
  CLI::App app("Palpate turns a scanned head into one that can be felt.", "palpate");
  app.set_version_flag("--version", kVersion);
  app.require_subcommand(1);
  app.footer(
      "Start with:  palpate build scan.obj -o head.glb\n"
      "then:        palpate view head.glb\n"
      "Exit codes: 0 done, 1 a bug, 2 the input cannot be used, 3 a solve failed, 4 a file could "
      "not be\n"
      "written, 130 stopped by the user.");
  add_build_command(app);
  add_stage_commands(app);
  add_sweep_commands(app);
  add_head_commands(app);
  add_compare_command(app);
  add_touch_commands(app);
  add_study_commands(app);
  add_study_analyse_command(app);
  add_verify_command(app);
  add_completion_command(app);
  try {
    std::vector<std::string> words = expand_config(app, {argv + 1, argv + argc});
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
    app.parse(words);
    return kOk;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    fmt::print(stderr, "palpate: {} (try --help)\n", worded(error));
    return kInput;
  } catch (const InputError& error) {
    say(error);
    return kInput;
  } catch (const SolveError& error) {
    say(error);
    return kSolve;
  } catch (const FileError& error) {
    say(error);
    return kFile;
  } catch (const Cancelled& error) {
    say(error);
    return kCancelled;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "palpate: not enough memory; close other programs or give a smaller scan\n");
    return kInput;
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate: internal error, please report it: {}\n", worded(error));
    return kBug;
  }
}

}  // namespace
}  // namespace palpate::app

int main(int argc, char** argv) {
  return palpate::app::run(argc, argv);
}
