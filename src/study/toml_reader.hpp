// SPDX-License-Identifier: GPL-3.0-or-later
// One table of a TOML file, read key by key: every refusal names file and line; a key that nobody
// asked for is refused at the end. Private to this folder.
#pragma once
#include <toml++/toml.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace palpate::study {

class TomlTable {
 public:
  /// @param what  for messages: "part touch"
  TomlTable(const toml::table& table, std::string file, std::string what);

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key);  ///< required, not empty
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise);
  [[nodiscard]] double number(const std::string& key, double otherwise, double least, double most);
  [[nodiscard]] int integer(const std::string& key, int otherwise, int least, int most);
  [[nodiscard]] bool boolean(const std::string& key, bool otherwise);
  /// Required; not empty; each once.
  [[nodiscard]] std::vector<std::string> words(const std::string& key, bool repeats = false);
  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t count, double least,
                                            double most);
  [[nodiscard]] TomlTable table(const std::string& key, const std::string& what);
  [[nodiscard]] std::vector<TomlTable> tables(const std::string& key, const std::string& what);

  /// All keys were asked for. @throws InputError  names the first that was not, and the likeliest
  /// of those that were
  void finish() const;
  /// @throws InputError  at the line of `key`, or of the table where it is missing
  [[noreturn]] void refuse(const std::string& key, const std::string& why) const;
  void name(const std::string& what) { what_ = what; }  ///< for messages from here on

 private:
  const toml::node* find(const std::string& key);
  const toml::array& list(const std::string& key);
  [[noreturn]] void refuse_at(const toml::source_region& where, const std::string& why) const;

  const toml::table* table_;
  std::string file_;
  std::string what_;
  std::set<std::string> asked_;
};

/// @throws InputError  file and line of a syntax error
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& file);

}  // namespace palpate::study
