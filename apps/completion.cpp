// SPDX-License-Identifier: GPL-3.0-or-later
// Shell completion, made from the parser itself so that it cannot go stale.
#include <fmt/format.h>

#include "apps/command_line.hpp"

namespace palpate::app {

static std::string long_options(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) words += " --" + name;
  return words;
}

static std::string bash_completion(const CLI::App& app) {
  std::string names, cases;
  for (const CLI::App* sub : app.get_subcommands({})) {
    names += " " + sub->get_name();
    cases += fmt::format("    {}) words=\"{}\" ;;\n", sub->get_name(), long_options(*sub));
  }
  return fmt::format(
      "_palpate() {{\n"
      "  local current=${{COMP_WORDS[COMP_CWORD]}} words=\n"
      "  case ${{COMP_WORDS[1]}} in\n{}"
      "    *) words=\"{} --help --version\" ;;\n  esac\n"
      "  [[ $COMP_CWORD == 1 ]] && words=\"{} --help --version\"\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\") $(compgen -f -- \"$current\"))\n"
      "}}\ncomplete -o filenames -F _palpate palpate\n",
      cases, names, names);
}

void add_completion_command(CLI::App& app) {
  auto* sub =
      app.add_subcommand("completion", "print the completion script for bash (zsh: bashcompinit)");
  sub->footer("Use:  source <(palpate completion)");
  sub->callback([&app] { fmt::print("{}", bash_completion(app)); });
}

}  // namespace palpate::app
