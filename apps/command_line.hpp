// SPDX-License-Identifier: GPL-3.0-or-later
// What the subcommands share: option groups, output of results, errors as exit codes.
#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/pipeline.hpp"

namespace palpate::app {

/// Documented in docs/command-line.md.
enum ExitCode { kOk = 0, kBug = 1, kInput = 2, kSolve = 3, kFile = 4, kCancelled = 130 };

/// One subcommand's settings; lives as long as the parse and the run.
struct Command {
  PipelineOptions options;
  std::filesystem::path input;
  std::filesystem::path output;
  std::vector<std::string> landmark_words;  ///< name=x,y,z
  std::filesystem::path landmark_file;
  std::string landmark_method = "robust";
  std::string fit_method = "depth";
  std::string tissue_model = "published";
  double youngs_modulus_kpa = 0;  ///< 0: as the tissue model says
  double poissons_ratio = -1;     ///< < 0: likewise
  std::string preset = "default";
  std::vector<const CLI::Option*> fixed_by_published;  ///< what `--preset published` sets itself
  std::vector<const CLI::Option*> published_only;
  std::string mode = "fast";
  std::string organs = "supported";
  std::string shard;   ///< "i/n", i from 1
  std::string config;  ///< read before the parse; here for --help
  bool json = false;
  bool quiet = false;
  int threads = 0;

  /// Moves the parsed words into `options`. @throws InputError names the option
  void finish();
};

using CommandPtr = std::shared_ptr<Command>;

/// Adds a subcommand; `work` runs when it was chosen and parsed.
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& what,
                         const std::string& footer, const CommandPtr& command,
                         const std::function<void(Command&)>& work);

void add_scan_options(CLI::App* sub, const CommandPtr& c);      ///< SCAN, --unit, --edge
void add_landmark_options(CLI::App* sub, const CommandPtr& c);  ///< --landmarks, --landmark, ...
void add_fit_options(CLI::App* sub, const CommandPtr& c);  ///< --fit, --clearance, --template, ...
void add_tissue_options(CLI::App* sub, const CommandPtr& c);  ///< --max-volume, ...
void add_sweep_options(CLI::App* sub,
                       const CommandPtr& c);             ///< --preset, --mode, --sites, ...
void add_own_skull(CLI::App* sub, const CommandPtr& c);  ///< --skull
void add_output_option(CLI::App* sub, const CommandPtr& c, const std::string& what);

/// The result: JSON on standard output with --json, else the lines `text`.
void print_result(const Command& command, const nlohmann::json& result, const std::string& text);
/// @throws FileError before hours of work, not after: the folder is missing or cannot be written
void check_writable(const std::filesystem::path& output);

// One function per group of subcommands; main.cpp calls them.
void add_build_command(CLI::App& app);
void add_stage_commands(CLI::App& app);         ///< repair, landmarks, place, fit, mesh
void add_sweep_commands(CLI::App& app);         ///< sweep, merge
void add_head_commands(CLI::App& app);          ///< inspect, export, report
void add_compare_command(CLI::App& app);        ///< compare
void add_touch_commands(CLI::App& app);         ///< touch, view, feel, devices, replay
void add_study_commands(CLI::App& app);         ///< study run, check, withdraw, upgrade
void add_study_analyse_command(CLI::App& app);  ///< study analyse
void add_verify_command(CLI::App& app);         ///< verify
void add_completion_command(CLI::App& app);

}  // namespace palpate::app
