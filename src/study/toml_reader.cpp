// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace palpate::study {
namespace {

/// Letters to change, insert or leave out (V. I. Levenshtein, 1966).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw InputError(
        fmt::format("{}:{}: not TOML: {}", file, error.source().begin.line, error.description()));
  }
}

TomlTable::TomlTable(const toml::table& table, std::string file, std::string what)
    : table_(&table), file_(std::move(file)), what_(std::move(what)) {}

void TomlTable::refuse_at(const toml::source_region& where, const std::string& why) const {
  throw InputError(fmt::format("{}:{}: {}: {}", file_, where.begin.line, what_, why));
}

void TomlTable::refuse(const std::string& key, const std::string& why) const {
  for (const auto& [name, node] : *table_)
    if (name.str() == key) refuse_at(name.source(), fmt::format("{}: {}", key, why));
  refuse_at(table_->source(), fmt::format("{}: {}", key, why));
}

bool TomlTable::has(const std::string& key) const {
  return table_->contains(key);
}

const toml::node* TomlTable::find(const std::string& key) {
  asked_.insert(key);
  return table_->get(key);
}

std::string TomlTable::text(const std::string& key) {
  if (!find(key)) refuse(key, "is missing; give a text");
  const std::string value = text(key, "");
  if (value.empty()) refuse(key, "is empty; give a text");
  return value;
}

std::string TomlTable::text(const std::string& key, const std::string& otherwise) {
  const toml::node* node = find(key);
  if (!node) return otherwise;
  if (const auto* value = node->as_string()) return value->get();
  refuse(key, "expects a text in quotes");
}

double TomlTable::number(const std::string& key, double otherwise, double least, double most) {
  const toml::node* node = find(key);
  if (!node) return otherwise;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !(*value >= least && *value <= most))
    refuse(key, fmt::format("expects a number from {} to {}", least, most));
  return *value;
}

int TomlTable::integer(const std::string& key, int otherwise, int least, int most) {
  const toml::node* node = find(key);
  if (!node) return otherwise;
  const auto* value = node->as_integer();
  if (!value || value->get() < least || value->get() > most)
    refuse(key, fmt::format("expects a whole number from {} to {}", least, most));
  return static_cast<int>(value->get());
}

bool TomlTable::boolean(const std::string& key, bool otherwise) {
  const toml::node* node = find(key);
  if (!node) return otherwise;
  if (const auto* value = node->as_boolean()) return value->get();
  refuse(key, "expects true or false");
}

const toml::array& TomlTable::list(const std::string& key) {
  const toml::node* node = find(key);
  if (!node) refuse(key, "is missing; give a list in brackets");
  const toml::array* array = node->as_array();
  if (!array || array->empty()) refuse(key, "expects a list in brackets, not empty");
  return *array;
}

std::vector<std::string> TomlTable::words(const std::string& key, bool repeats) {
  std::vector<std::string> all;
  for (const toml::node& item : list(key)) {
    const auto* value = item.as_string();
    if (!value) refuse(key, "expects texts in quotes");
    if (!repeats && std::find(all.begin(), all.end(), value->get()) != all.end())
      refuse(key, fmt::format("{} appears twice", value->get()));
    all.push_back(value->get());
  }
  return all;
}

std::vector<double> TomlTable::numbers(const std::string& key, std::size_t count, double least,
                                       double most) {
  const std::string want = fmt::format("expects {} numbers from {} to {}", count, least, most);
  std::vector<double> all;
  for (const toml::node& item : list(key)) {
    const auto value = item.is_number() ? item.value<double>() : std::nullopt;
    if (!value || !(*value >= least && *value <= most)) refuse(key, want);
    all.push_back(*value);
  }
  if (all.size() != count) refuse(key, want);
  return all;
}

TomlTable TomlTable::table(const std::string& key, const std::string& what) {
  const toml::node* node = find(key);
  if (!node) refuse(key, "is missing; give a table");
  if (!node->is_table()) refuse(key, "expects a table: { key = value }");
  return {*node->as_table(), file_, what};
}

std::vector<TomlTable> TomlTable::tables(const std::string& key, const std::string& what) {
  std::vector<TomlTable> all;
  for (const toml::node& item : list(key)) {
    if (!item.is_table()) refuse(key, fmt::format("expects tables: [[{}]]", key));
    all.emplace_back(*item.as_table(), file_, what);
  }
  return all;
}

void TomlTable::finish() const {
  for (const auto& [name, node] : *table_) {
    const std::string key(name.str());
    if (asked_.contains(key)) continue;
    const auto nearest = std::min_element(asked_.begin(), asked_.end(),
                                          [&](const std::string& a, const std::string& b) {
                                            return distance(a, key) < distance(b, key);
                                          });
    constexpr std::size_t kMisspelt = 3;  // letters; more is another word
    const bool misspelt = nearest != asked_.end() && distance(*nearest, key) <= kMisspelt;
    refuse_at(name.source(),
              fmt::format("unknown key {}; {}", key,
                          misspelt ? fmt::format("did you mean {}?", *nearest)
                                   : fmt::format("known are {}", fmt::join(asked_, ", "))));
  }
}

}  // namespace palpate::study
