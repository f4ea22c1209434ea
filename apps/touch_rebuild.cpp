// SPDX-License-Identifier: GPL-3.0-or-later
// The command that computes a head again from its own file.
#include <fmt/format.h>

#include <algorithm>

#include "apps/describe.hpp"
#include "apps/touch_points.hpp"

namespace palpate::app {
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct Option {
  const char* key;   ///< in provenance.options
  const char* flag;  ///< of `palpate build`
};
constexpr Option kOptions[] = {
    {"edge_mm", "--edge"},
    {"landmarks", "--landmarks"},
    {"fit", "--fit"},
    {"clearance_mm", "--clearance"},
    {"template", "--template"},
    {"depths", "--depths"},
    {"own_skull", "--skull"},
    {"tissue_max_volume_mm3", "--max-volume"},
    {"tool_radius_mm", "--tool-radius"},
    {"preset", "--preset"},
    {"mode", "--mode"},
    {"published_reach_mm", "--reach"},
    {"organs", "--organs"},
    {"organ_give_mm_per_n", "--organ-give"},
    {"loads", "--loads"},
    {"max_force_n", "--max-force"},
    {"sites", "--sites"},
    {"error_bound", "--error-bound"},
    {"modulus_spread", "--modulus-spread"},
    {"seed", "--seed"},
};
/// What `--preset published` sets itself and refuses beside it.
constexpr std::string_view kFixedByPublished[] = {
    "mode", "error_bound", "tool_radius_mm", "modulus_spread", "organs", "organ_give_mm_per_n"};

json recorded_options(const json& provenance) {
  return provenance.is_object() && provenance.contains("options") &&
                 provenance["options"].is_object()
             ? provenance["options"]
             : json::object();
}

std::string tissue_words(const json& model, const json& usual) {
  if (!model.is_object() || model == usual) return {};
  std::string words;
  if (model.value("name", json()) != usual["name"] && model.value("name", json()).is_string())
    words += " --tissue-model " + quoted(model["name"].get<std::string>());
  if (model.value("model", json()) != "uniform") return words;
  for (const auto& [key, flag] : {std::pair{"youngs_modulus_kpa", "--youngs-modulus-kpa"},
                                  {"poissons_ratio", "--poissons-ratio"}})
    if (model.value(key, json()) != usual[key] && model.value(key, json()).is_number())
      words += fmt::format(" {} {}", flag, model[key].dump());
  return words;
}

}  // namespace

fs::path points_file(const fs::path& head) {
  return head.parent_path() / (head.stem().string() + ".landmarks.txt");
}

std::string no_fit_because(const json& provenance) {
  const json options = recorded_options(provenance);
  for (const char* image : {"ct", "labels"})
    if (options.value(image, json("")) != "")
      return "the skull of this head was taken from an image, not fitted: points do not move it";
  if (options.value("own_skull", json("")) != "")
    return "this head has a skull of your own, not a fitted one: points do not move it";
  for (const char* own : {"template", "depths"})
    if (const json file = options.value(own, json("")); file.is_string() && file != "")
      return fmt::format(
          "this head was made with {}, which its file does not hold: use the command",
          file.get<std::string>());
  return {};
}

std::string build_command_line(const fs::path& head, const json& provenance) {
  const json usual = describe(PipelineOptions{});
  const json options = recorded_options(provenance);
  const bool published = options.value("preset", json("")) == "published";
  std::string line = fmt::format("palpate build {} --landmark-file {}", quoted(head.string()),
                                 quoted(points_file(head).string()));
  for (const Option& o : kOptions) {
    if (!options.contains(o.key) || options[o.key] == usual[o.key] || options[o.key].is_null())
      continue;
    if (published && std::find(std::begin(kFixedByPublished), std::end(kFixedByPublished), o.key) !=
                         std::end(kFixedByPublished))
      continue;
    const json& v = options[o.key];
    line += fmt::format(" {} {}", o.flag, quoted(v.is_string() ? v.get<std::string>() : v.dump()));
  }
  if (!published && options.contains("tissue_model"))
    line += tissue_words(options["tissue_model"], usual["tissue_model"]);
  const fs::path output = head.parent_path() / (head.stem().string() + ".moved.glb");
  return line + " -o " + quoted(output.string());
}

}  // namespace palpate::app
