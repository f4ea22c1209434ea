// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/tissue_file.hpp"

#include <fmt/format.h>

#include <toml++/toml.h>
#include <algorithm>
#include <set>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/assets.hpp"

namespace palpate::app {
namespace {

using stiffness::TissueKind;
using stiffness::TissueLaw;
using stiffness::TissueModel;
namespace fs = std::filesystem;

constexpr double kMpaPerKpa = 1e-3;
constexpr std::array<std::string_view, 3> kKinds = {"uniform", "regional", "layered"};
constexpr std::array<std::string_view, 2> kLaws = {"neo-hookean", "mooney-rivlin"};

class TissueFile {
 public:
  explicit TissueFile(fs::path path) : path_(std::move(path)) {
    try {
      root_ = toml::parse(read_file(path_), path_.string());
    } catch (const toml::parse_error& error) {
      refuse(error.source(), std::string(error.description()));
    }
  }

  TissueModel read() {
    TissueModel m;
    m.name = path_.stem().string();
    m.kind = static_cast<TissueKind>(choice(root_, "model", kKinds, true));
    m.source = text(root_, "source", true);
    if (m.kind == TissueKind::layered) {
      only(root_, {"model", "source", "layer"});
      read_layers(m);
    } else {
      m.poissons_ratio = number(root_, "poissons_ratio");
      m.law = static_cast<TissueLaw>(choice(root_, "law", kLaws, false));
      if (m.kind == TissueKind::uniform) {
        only(root_, {"model", "source", "poissons_ratio", "law", "youngs_modulus_kpa"});
        m.youngs_modulus = kMpaPerKpa * number(root_, "youngs_modulus_kpa");
      } else {
        read_regions(m);
      }
    }
    try {
      stiffness::check(m);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", path_.string(), error.what()));
    }
    return m;
  }

 private:
  [[noreturn]] void refuse(const toml::source_region& where, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", path_.string(), where.begin.line, what));
  }
  void only(const toml::table& table, const std::set<std::string_view>& known) const {
    for (const auto& [key, value] : table)
      if (!known.contains(key.str()))
        refuse(key.source(), fmt::format("unknown key {}", key.str()));
  }
  double number(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (!node) refuse(table.source(), fmt::format("{} is missing", key));
    const auto value = node->value<double>();
    if (!value || !node->is_number()) refuse(node->source(), fmt::format("{}: not a number", key));
    return *value;
  }
  std::string text(const toml::table& table, std::string_view key, bool needed) const {
    const toml::node* node = table.get(key);
    if (!node && !needed) return "";
    if (!node) refuse(table.source(), fmt::format("{} is missing", key));
    if (!node->is_string()) refuse(node->source(), fmt::format("{}: expects a text", key));
    return node->as_string()->get();
  }
  /// Index of the text in `words`; the first where it is absent and not needed.
  template <std::size_t n>
  std::size_t choice(const toml::table& table, std::string_view key,
                     const std::array<std::string_view, n>& words, bool needed) const {
    const std::string word = text(table, key, needed);
    if (word.empty() && !table.get(key)) return 0;
    const auto at = std::find(words.begin(), words.end(), word);
    if (at == words.end())
      refuse(table.get(key)->source(),
             fmt::format("{}: '{}' is none of {}", key, word, fmt::join(words, ", ")));
    return static_cast<std::size_t>(at - words.begin());
  }

  void read_regions(TissueModel& m) const {
    only(root_, {"model", "source", "poissons_ratio", "law", "elsewhere_kpa", "blend_mm",
                 "youngs_modulus_kpa"});
    m.youngs_modulus = kMpaPerKpa * number(root_, "elsewhere_kpa");
    if (root_.get("blend_mm")) m.blend = number(root_, "blend_mm");
    const toml::node* node = root_.get("youngs_modulus_kpa");
    if (!node || !node->is_table())
      refuse(root_.source(), "[youngs_modulus_kpa] with one key per region is missing");
    for (const auto& [key, value] : *node->as_table()) {
      const auto at = std::find(kSkinRegionNames.begin(), kSkinRegionNames.end(), key.str());
      if (at == kSkinRegionNames.end())
        refuse(key.source(), fmt::format("'{}' is no region of the skin", key.str()));
      const double kpa = number(*node->as_table(), key.str());
      if (!(kpa > 0)) refuse(value.source(), fmt::format("{}: must be > 0", key.str()));
      m.by_region[at - kSkinRegionNames.begin()] = kMpaPerKpa * kpa;
    }
  }
  void read_layers(TissueModel& m) const {
    const toml::node* node = root_.get("layer");
    if (!node || !node->is_array_of_tables()) refuse(root_.source(), "has no [[layer]]");
    for (const toml::node& entry : *node->as_array()) {
      const toml::table& t = *entry.as_table();
      only(t, {"name", "share_of_depth", "youngs_modulus_kpa", "poissons_ratio", "law"});
      m.layers.push_back({text(t, "name", true), number(t, "share_of_depth"),
                          kMpaPerKpa * number(t, "youngs_modulus_kpa"), number(t, "poissons_ratio"),
                          static_cast<TissueLaw>(choice(t, "law", kLaws, false))});
    }
  }

  fs::path path_;
  toml::table root_;
};

}  // namespace

stiffness::TissueModel read_tissue_model(const std::string& word) {
  const bool bundled = word == "published" || word == "regional" || word == "layered";
  return TissueFile(bundled ? io::data_folder() / "tissue" / (word + ".toml") : fs::path(word))
      .read();
}

nlohmann::json describe(const TissueModel& m) {
  nlohmann::json out = {
      {"name", m.name}, {"model", kKinds[static_cast<std::size_t>(m.kind)]}, {"source", m.source}};
  if (m.kind == TissueKind::layered) {
    for (const stiffness::TissueLayer& l : m.layers)
      out["layers"].push_back({{"name", l.name},
                               {"share_of_depth", l.share},
                               {"youngs_modulus_kpa", l.youngs_modulus / kMpaPerKpa},
                               {"poissons_ratio", l.poissons_ratio},
                               {"law", kLaws[static_cast<std::size_t>(l.law)]}});
    return out;
  }
  out["poissons_ratio"] = m.poissons_ratio;
  out["law"] = kLaws[static_cast<std::size_t>(m.law)];
  out[m.kind == TissueKind::regional ? "elsewhere_kpa" : "youngs_modulus_kpa"] =
      m.youngs_modulus / kMpaPerKpa;
  if (m.kind != TissueKind::regional) return out;
  out["blend_mm"] = m.blend;
  for (std::size_t r = 0; r < m.by_region.size(); ++r)
    if (m.by_region[r] > 0)
      out["youngs_modulus_kpa"][std::string(kSkinRegionNames[r])] = m.by_region[r] / kMpaPerKpa;
  return out;
}

}  // namespace palpate::app
