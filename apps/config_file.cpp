// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/config_file.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"

namespace palpate::app {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const toml::source_region& where,
                         const std::string& what) {
  throw InputError(fmt::format("{}:{}: {}", path.string(), where.begin.line, what));
}

/// One scalar as the text that the command line would carry.
std::string scalar_text(const std::filesystem::path& path, std::string_view key,
                        const toml::node& value) {
  if (const auto* s = value.as_string()) return s->get();
  if (const auto* i = value.as_integer()) return fmt::format("{}", i->get());
  if (const auto* f = value.as_floating_point()) return fmt::format("{}", f->get());
  refuse(path, value.source(), fmt::format("{}: expects a text or a number", key));
}

void append_table(const std::filesystem::path& path, std::string_view key, const toml::table& table,
                  std::vector<std::string>& words) {
  for (const auto& [name, value] : table) {
    const toml::array* xyz = value.as_array();
    if (!xyz || xyz->size() != 3)
      refuse(path, value.source(), fmt::format("{}.{}: expects [x, y, z]", key, name.str()));
    words.push_back(
        fmt::format("--{}={}={},{},{}", key, name.str(), scalar_text(path, key, (*xyz)[0]),
                    scalar_text(path, key, (*xyz)[1]), scalar_text(path, key, (*xyz)[2])));
  }
}

}  // namespace

std::vector<std::string> read_config(const std::filesystem::path& path,
                                     const std::set<std::string>& known) {
  toml::table table;
  try {
    table = toml::parse(read_file(path), path.string());
  } catch (const toml::parse_error& error) {
    refuse(path, error.source(), std::string(error.description()));
  }
  std::vector<std::string> words;
  for (const auto& [key, value] : table) {
    const std::string name(key.str());
    if (!known.contains(name))
      refuse(path, key.source(),
             fmt::format("unknown key {}; `palpate build --help` lists them", name));
    if (const auto* flag = value.as_boolean()) {
      if (flag->get()) words.push_back("--" + name);
    } else if (const auto* list = value.as_array()) {
      for (const toml::node& item : *list)
        words.push_back(fmt::format("--{}={}", name, scalar_text(path, name, item)));
    } else if (const auto* nested = value.as_table()) {
      append_table(path, name, *nested, words);
    } else {
      words.push_back(fmt::format("--{}={}", name, scalar_text(path, name, value)));
    }
  }
  return words;
}

}  // namespace palpate::app
