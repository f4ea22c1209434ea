// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/command_line.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <sstream>
#include <tuple>

#include "apps/describe.hpp"
#include "apps/tissue_file.hpp"
#include "core/error.hpp"

namespace palpate::app {
namespace fs = std::filesystem;

static std::pair<std::string, Vec3> parse_landmark(const std::string& word) {
  const auto equals = word.find('=');
  std::istringstream in(equals == std::string::npos ? "" : word.substr(equals + 1));
  in.imbue(std::locale::classic());
  Vec3 p;
  char comma1 = 0, comma2 = 0, rest = 0;
  if (!(in >> p.x() >> comma1 >> p.y() >> comma2 >> p.z()) || comma1 != ',' || comma2 != ',' ||
      (in >> rest) || !p.allFinite())
    throw InputError(
        fmt::format("--landmark {}: write name=x,y,z in the scan's own coordinates", word));
  return {word.substr(0, equals), p};
}

static std::pair<int, int> parse_shard(const std::string& word) {
  int index = 0, count = 0, used = 0;
  if (std::sscanf(word.c_str(), "%d/%d%n", &index, &count, &used) != 2 ||
      used != static_cast<int>(word.size()) || index < 1 || index > count)
    throw InputError(fmt::format("--shard {}: write i/n with 1 <= i <= n", word));
  return {index - 1, count};
}

/// The model, and what the command line changes in a uniform one.
static void finish_tissue(Command& c) {
  stiffness::TissueModel& model = c.options.sweep.tissue;
  if (c.tissue_model != model.name) model = read_tissue_model(c.tissue_model);
  const bool changed = c.youngs_modulus_kpa > 0 || c.poissons_ratio >= 0;
  if (changed && model.kind != stiffness::TissueKind::uniform)
    throw InputError(
        fmt::format("--youngs-modulus-kpa and --poissons-ratio change a uniform model; "
                    "{} is not one",
                    c.tissue_model));
  if (changed) model.source = "given on the command line";
  if (c.youngs_modulus_kpa > 0) model.youngs_modulus = c.youngs_modulus_kpa * 1e-3;
  if (c.poissons_ratio >= 0) model.poissons_ratio = c.poissons_ratio;
}

/// The preset is a whole recipe: an option that would change it in part is refused, not mixed in.
static void finish_preset(Command& c) {
  const bool published = c.preset == "published";
  for (const CLI::Option* option : published ? c.fixed_by_published : c.published_only)
    if (option->count() > 0)
      throw InputError(
          published
              ? fmt::format("{}: `--preset published` presses with a force on one node and the "
                            "source's own tissue and method; leave {} out",
                            option->get_name(), option->get_name())
              : fmt::format("{}: goes with `--preset published` only", option->get_name()));
  c.options.sweep.mode = published           ? stiffness::SweepMode::published
                         : c.mode == "exact" ? stiffness::SweepMode::exact
                                             : stiffness::SweepMode::fast;
  c.options.sweep.organs.organs =
      published || c.organs == "held" ? stiffness::Organs::held : stiffness::Organs::supported;
}

void Command::finish() {
  if (!landmark_file.empty()) options.landmarks.given = read_landmark_file(landmark_file);
  for (const std::string& word : landmark_words) {
    const auto [name, position] = parse_landmark(word);
    options.landmarks.given[name] = position;
  }
  options.landmarks.method =
      landmark_method == "published" ? landmarks::Method::published : landmarks::Method::robust;
  options.fit.method = fit_method == "published" ? skull::Method::published : skull::Method::depth;
  finish_tissue(*this);
  finish_preset(*this);
  if (!shard.empty()) std::tie(options.sweep.shard, options.sweep.shard_count) = parse_shard(shard);
  options.sweep.threads = threads;
}

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& what,
                         const std::string& footer, const CommandPtr& command,
                         const std::function<void(Command&)>& work) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  sub->footer(footer);
  sub->add_flag("--json", command->json, "machine-readable result on standard output");
  sub->add_flag("--quiet", command->quiet, "no progress on standard error");
  sub->add_option("--threads", command->threads, "0 = all cores; the result does not depend on it")
      ->check(CLI::Range(0, 4096));
  sub->add_option("--config", command->config,
                  "TOML file with options by their long names; the command line wins");
  sub->callback([command, work] {
    command->finish();
    work(*command);
  });
  return sub;
}

void add_scan_options(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("SCAN", c->input, "head scan: .obj .ply .stl .off .gltf .glb")->required();
  sub->add_option("--unit", c->options.unit,
                  "unit of the scan; guessed from a head's size if absent")
      ->check(CLI::IsMember({"mm", "cm", "dm", "m", "inch"}));
  sub->add_option("--edge", c->options.repair.target_edge, "[mm] edge of the working mesh")
      ->check(CLI::Range(1.0, 10.0))
      ->capture_default_str();
}

void add_landmark_options(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("--landmarks", c->landmark_method, "how the face's points are found")
      ->check(CLI::IsMember({"robust", "published"}))
      ->capture_default_str();
  sub->add_option("--landmark", c->landmark_words,
                  "name=x,y,z in the scan's own coordinates; overrides what was found; may repeat")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub->add_option("--landmark-file", c->landmark_file,
                  "JSON as `palpate landmarks --json` prints it, or the text of --edit");
}

void add_fit_options(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("--fit", c->fit_method, "depth: published tissue depths; published: weighted FFD")
      ->check(CLI::IsMember({"depth", "published"}))
      ->capture_default_str();
  sub->add_option("--clearance", c->options.fit.clearance, "[mm] least distance from skin to bone")
      ->check(CLI::Range(0.5, 10.0))
      ->capture_default_str();
  sub->add_option("--template", c->options.skull_template,
                  "skull template .ply with its .json; default: bundled");
  sub->add_option("--depths", c->options.depth_table, "tissue depth table .csv; default: bundled");
}

void add_tissue_options(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("--max-volume", c->options.tissue.max_volume,
                  "[mm^3] largest tetrahedron of the tissue mesh")
      ->check(CLI::Range(0.5, 1e4))
      ->capture_default_str();
}

void add_sweep_options(CLI::App* sub, const CommandPtr& c) {
  auto& s = c->options.sweep;
  const auto fixed = [&c](const CLI::Option* option) { c->fixed_by_published.push_back(option); };
  sub->add_option("--preset", c->preset,
                  "default: sphere, neo-Hookean flesh, quadratic elements; published: the thesis' "
                  "own press, a force on one node of linear Saint-Venant-Kirchhoff tissue, stepped "
                  "to rest, to see what it does: vertices where it turns tissue inside out say so")
      ->check(CLI::IsMember({"default", "published"}))
      ->capture_default_str();
  c->published_only.push_back(
      sub->add_option("--reach", s.published.reach,
                      "[mm] --preset published: how far around a site the head's tetrahedra are "
                      "taken; 1000 takes all (minutes per load)")
          ->check(CLI::Range(5.0, 1000.0))
          ->capture_default_str());
  fixed(sub->add_option("--mode", c->mode,
                        "fast: coarse presses, full ones where the predicted error asks for it; "
                        "exact: every vertex on tissue in full")
            ->check(CLI::IsMember({"fast", "exact"}))
            ->capture_default_str());
  sub->add_option("--sites", s.sites,
                  "vertices that are solved in full; 0: 300 in fast mode, 40 in the published "
                  "preset, all in exact mode (where fewer are asked for, the rest is blended)")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  fixed(sub->add_option("--error-bound", s.error_bound,
                        "largest predicted error of a learned curve in fast mode")
            ->check(CLI::Range(0.001, 1.0))
            ->capture_default_str());
  fixed(
      sub->add_option("--tool-radius", s.tool_radius, "[mm] sphere that presses; 8 is a fingertip")
          ->check(CLI::Range(1.0, 30.0))
          ->capture_default_str());
  fixed(sub->add_option("--organs", c->organs,
                        "supported: the globe of the eye and the cartilage of the nose carry the "
                        "skin, lips lie on teeth; held: no curve on eyes, nose and lips, as in the "
                        "source")
            ->check(CLI::IsMember({"supported", "held"}))
            ->capture_default_str());
  fixed(sub->add_option("--organ-give", s.organs.give,
                        "[mm/N] how far globe and cartilage give way; an assumption")
            ->check(CLI::Range(0.0, 20.0))
            ->capture_default_str());
  sub->add_option("--max-force", s.max_force, "[N] largest of the equal force steps")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  sub->add_option("--loads", s.loads, "number of force steps")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  fixed(sub->add_option("--tissue-model", c->tissue_model,
                        "published, regional, layered or a .toml: what the flesh is made of")
            ->capture_default_str());
  fixed(sub->add_option("--youngs-modulus-kpa", c->youngs_modulus_kpa,
                        "[kPa] of the flesh, instead of the published 45.658")
            ->check(CLI::Range(0.1, 1e4)));
  fixed(sub->add_option("--poissons-ratio", c->poissons_ratio,
                        "[-] of the flesh, instead of the published 0.43")
            ->check(CLI::Range(0.0, 0.495)));
  fixed(sub->add_option("--modulus-spread", c->options.spread.modulus_spread,
                        "[-] SD of ln E between people, for the error bars of the stiffness")
            ->check(CLI::Range(0.0, 3.0))
            ->capture_default_str());
  sub->add_option("--checkpoint", s.checkpoint,
                  "file that keeps what is solved; the same command goes on from it");
  sub->add_option("--seed", s.seed, "for the choice of sites")->capture_default_str();
}

void add_own_skull(CLI::App* sub, const CommandPtr& c) {
  sub->add_option("--skull", c->options.own_skull,
                  "skull surface (scan frame, mm), for example from `palpate fit`");
}

void add_output_option(CLI::App* sub, const CommandPtr& c, const std::string& what) {
  sub->add_option("-o,--output", c->output, what)->required();
}

void print_result(const Command& command, const nlohmann::json& result, const std::string& text) {
  if (command.json)
    fmt::print("{}\n", result.dump(2));
  else
    fmt::print("{}", text);
  if (std::fflush(stdout) != 0) throw FileError("standard output: cannot be written");
}

void check_writable(const fs::path& output) {
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw FileError(fmt::format("{}: the folder {} does not exist; create it first",
                                output.string(), folder.string()));
  if (fs::is_directory(output, error))
    throw FileError(fmt::format("{}: is a folder; name a file in it", output.string()));
  if (::access(folder.c_str(), W_OK) != 0)
    throw FileError(fmt::format("{}: the folder {} cannot be written; choose another",
                                output.string(), folder.string()));
}

}  // namespace palpate::app
