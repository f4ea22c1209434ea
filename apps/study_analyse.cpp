// SPDX-License-Identifier: GPL-3.0-or-later
// palpate study analyse: study file -> a folder with report, figures, tables and BIDS. The folder
// is made beside its place and renamed, and it replaces an older one as a whole: files of somebody
// who has withdrawn since cannot stay behind in it.
#include "apps/study_analyse.hpp"

#include <fmt/format.h>

#include <cmath>

#include "apps/command_line.hpp"
#include "apps/terminal_progress.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "study/export.hpp"
#include "study/store.hpp"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kMark = "analysis.json";  ///< a folder that holds it was made here

json number(double x) {
  return std::isfinite(x) ? json(x) : json(nullptr);
}

json summary(const study::StudyData& data, const study::Results& r) {
  json out = {{"study", data.study.id},
              {"protocol", data.study.protocol_name},
              {"simulated", data.study.simulated},
              {"participants", r.people.size()},
              {"unfinished", r.unfinished},
              {"excused", r.excused},
              {"withdrawn", r.withdrawn},
              {"regions", r.regions}};
  for (const auto& c : r.conditions)
    for (std::size_t k = 0; k < r.regions.size(); ++k)
      out["ratings"][c.id][r.regions[k]] = {{"n", c.regions[k].moments.n},
                                            {"mean", number(c.regions[k].moments.mean)},
                                            {"sd", number(c.regions[k].moments.sd)}};
  for (const auto& k : r.rankings)
    out["ranking"][k.experiment] = {{"pair_accuracy", number(k.accuracy.moments.mean)},
                                    {"perfect", k.perfect},
                                    {"tau_b", number(k.tau.mean)}};
  for (const auto& one : r.rationality)
    out["rationality"] = {{"mean", number(one.ratings.moments.mean)},
                          {"sd", number(one.ratings.moments.sd)},
                          {"reference", one.reference},
                          {"t", number(one.t.t)},
                          {"df", number(one.t.df)},
                          {"p", number(one.t.p)}};
  for (const auto& f : r.felt) out["felt_spearman"][f.experiment] = number(f.spearman.r);
  if (!r.discrimination.rows.empty())
    out["weber_fraction"] = {{"geometric_mean", number(r.discrimination.geometric_mean)},
                             {"low", number(r.discrimination.interval.low)},
                             {"high", number(r.discrimination.interval.high)},
                             {"unbounded", r.discrimination.unbounded}};
  return out;
}

/// @throws InputError  the folder holds something else; FileError  its parent cannot be written
void check_folder(const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::absolute(folder).lexically_normal();
  const fs::path parent = (whole.has_filename() ? whole : whole.parent_path()).parent_path();
  if (!fs::is_directory(parent, error))
    throw FileError(fmt::format("{}: the folder {} does not exist; create it first",
                                folder.string(), parent.string()));
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error))
    throw InputError(fmt::format("{}: is a file; name a folder", folder.string()));
  if (!fs::is_empty(folder, error) && !fs::exists(folder / kMark, error))
    throw InputError(fmt::format(
        "{}: holds files that no analysis wrote; name a new or an empty folder", folder.string()));
}

[[noreturn]] void file_error(const fs::path& path, const std::error_code& error) {
  throw FileError(fmt::format("{}: cannot be written: {}", path.string(), error.message()));
}

void replace_folder(const fs::path& made, const fs::path& folder) {
  const fs::path old = folder.string() + ".old";
  std::error_code error;
  fs::remove_all(old, error);
  if (fs::exists(folder)) {
    fs::rename(folder, old, error);
    if (error) file_error(folder, error);
  }
  fs::rename(made, folder, error);
  if (error) file_error(folder, error);
  fs::remove_all(old, error);
  if (error) file_error(old, error);
}

void write_files(const fs::path& folder, const std::vector<study::ExportFile>& files,
                 const Progress& progress) {
  const fs::path made = folder.string() + ".new";
  std::error_code error;
  fs::remove_all(made, error);
  try {
    for (const study::ExportFile& f : files) {
      const fs::path path = made / f.path;
      fs::create_directories(path.parent_path(), error);
      if (error) file_error(path.parent_path(), error);
      write_file(path, f.text);
      progress.step("write",
                    static_cast<double>(&f - files.data() + 1) / static_cast<double>(files.size()));
    }
    replace_folder(made, folder);
  } catch (...) {
    fs::remove_all(made, error);
    throw;
  }
}

void run_analyse(Command& c) {
  fs::path folder = c.output;
  if (!folder.has_filename()) folder = folder.parent_path();
  check_folder(folder);
  const auto progress = make_terminal_progress(c.quiet);
  const study::StudyData data = [&] {
    const auto store = study::Store::open(c.input, study::Store::Access::read);
    return study::read_study(store);
  }();
  const study::Results results = study::analyse(data);
  const json result = summary(data, results);
  const auto figures = study_figures(data, results);

  std::vector<study::ExportFile> files = study::tidy_tables(data, results);
  for (auto& f : study::bids_files(data)) files.push_back(std::move(f));
  for (const StudyFigure& f : figures) files.push_back({"figures/" + f.name + ".svg", f.svg});
  files.push_back({"report.html", study_report(data, results, figures)});
  files.push_back({kMark, result.dump(2) + "\n"});
  write_files(folder, files, *progress);
  print_result(c, result,
               fmt::format("{}{} participants; {}\n", data.study.simulated ? "SIMULATED: " : "",
                           results.people.size(), (folder / "report.html").string()));
}

}  // namespace

void add_study_analyse_command(CLI::App& app) {
  const auto found = app.get_subcommands([](CLI::App* one) { return one->get_name() == "study"; });
  CLI::App* group = found.empty()
                        ? app.add_subcommand("study", "run a study of a head, check it, analyse it")
                        : found.front();
  group->require_subcommand(1);
  auto c = std::make_shared<Command>();
  CLI::App* sub =
      add_subcommand(*group, "analyse", "study file -> report, figures, tables, BIDS",
                     "Example:  palpate study analyse study.db -o results", c, run_analyse);
  sub->add_option("STUDY", c->input, "study file, as `palpate study run` writes it")->required();
  add_output_option(
      sub, c,
      "folder for report.html, figures/, tables/ and bids/; one that an analysis made "
      "before is replaced");
}

}  // namespace palpate::app
