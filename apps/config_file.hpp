// SPDX-License-Identifier: GPL-3.0-or-later
// Options from a TOML file: the keys are the long options without the dashes.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace palpate::app {

/// Turns `key = value` into command-line words, in file order: booleans become the bare flag (or
/// nothing), arrays repeat the option, tables such as [landmark] become `--landmark name=x,y,z`.
/// @param known  the long options, without dashes, that the subcommand has
/// @throws InputError  file:line and the key, for a syntax error, an unknown key or a wrong type
[[nodiscard]] std::vector<std::string> read_config(const std::filesystem::path& path,
                                                   const std::set<std::string>& known);

}  // namespace palpate::app
