// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/touch_points.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "apps/command_line.hpp"
#include "apps/landmark_text.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "serve/live.hpp"

namespace palpate::app {
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr const char* kFitPath = "/fit.glb";

/// [s] where the head's file does not tell what its stages took.
const std::map<std::string, double> kUsualSeconds = {
    {"read", 0.2}, {"repair", 2}, {"landmarks", 2}, {"skull", 6}};

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

json numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

std::map<std::string, double> stage_seconds(const json& run) {
  std::map<std::string, double> expected = kUsualSeconds;
  const auto told = run.is_object() ? run.find("seconds") : run.end();
  if (!run.is_object() || told == run.end() || !told->is_object()) return expected;
  for (auto& [stage, seconds] : expected)
    if (const auto t = told->find(stage); t != told->end() && t->is_number())
      seconds = std::clamp(t->get<double>(), 0.0, 1e4);
  return expected;
}

fs::path make_folder() {
  std::string name = (fs::temp_directory_path() / "palpate-fit-XXXXXX").string();
  if (!mkdtemp(name.data())) throw FileError(name + ": the folder cannot be made");
  return name;
}

}  // namespace

PointsDesk::PointsDesk(const TouchableHead& head, const haptics::TouchModel& model,
                       fs::path head_file, Say say)
    : head_(head),
      model_(model),
      head_file_(fs::absolute(head_file)),
      file_(points_file(head_file_)),
      say_(std::move(say)),
      saved_(json::object()) {
  for (const auto& [name, mark] : head.landmarks)
    if (serve::is_plain_name(name)) names_.insert(name);
  load_saved();
  post();
}

PointsDesk::~PointsDesk() {
  stop_run();
}

/// Points that were moved earlier; a file that is no list of points is left alone.
void PointsDesk::load_saved() {
  constexpr std::uintmax_t kMost = 1U << 20;
  std::error_code error;
  if (!fs::is_regular_file(file_, error) || fs::file_size(file_, error) > kMost) return;
  try {
    for (const auto& [name, p] : parse_landmark_text(read_file(file_), file_.string()))
      if (names_.contains(name)) saved_[name] = numbers(head_.frame.to_head(head_.unit_mm * p));
  } catch (const InputError& problem) {
    note("refused", problem.what());
  }
}

void PointsDesk::look(serve::Server& server) {
  while (const auto message = channel_.take()) {
    try {
      apply(serve::parse_points_request(*message, names_));
    } catch (const std::runtime_error& problem) {
      note("refused", problem.what());
    }
  }
  if (run_) read_run(server);
}

void PointsDesk::apply(const serve::PointsRequest& request) {
  for (const auto& [name, p] : request.moved)
    if (!serve::press_place(model_, p))
      throw InputError(fmt::format("{} is more than 20 mm off the skin", name));
  switch (request.kind) {
    case serve::PointsRequest::Kind::save:
      return save(request);
    case serve::PointsRequest::Kind::run:
      return start(request);
    case serve::PointsRequest::Kind::stop:
      if (!run_) return;
      stop_run();
      return note("stopped", "stopped; the skull is the one before");
  }
}

std::string PointsDesk::text_of(const std::map<std::string, Vec3>& moved) const {
  LandmarkSet all;
  for (const std::string& name : names_) all[name] = head_.landmarks.at(name);
  for (const auto& [name, p] : moved) all[name] = {head_.frame.to_scan(p), 1};
  return landmark_text(all, head_.unit_mm);
}

void PointsDesk::save(const serve::PointsRequest& request) {
  std::error_code error;
  const bool there = fs::exists(fs::symlink_status(file_, error));
  if (there && !request.replace && (written_.empty() || read_file(file_) != written_))
    return note("exists", fmt::format("{} is there already", file_.string()));
  const std::string text = text_of(request.moved);
  write_file(file_, text);
  written_ = text;
  saved_ = json::object();
  for (const auto& [name, p] : request.moved) saved_[name] = numbers(p);
  say_(fmt::format("points written: {}", file_.string()));
  note("saved", fmt::format("{} written", file_.string()));
}

void PointsDesk::start(const serve::PointsRequest& request) {
  if (run_) return note("refused", "a fit is under way; stop it first");
  if (const std::string why = no_fit_because(head_.provenance); !why.empty())
    return note("refused", why);
  Run run;
  run.folder = make_folder();
  run.expected = stage_seconds(head_.run);
  run.started = run.stage_started = now_s();
  for (const auto& [stage, seconds] : run.expected) run.left += seconds;
  run_ = std::move(run);
  try {
    const std::string points = (run_->folder / "points.txt").string();
    write_file(points, text_of(request.moved));
    std::vector<std::string> words = {"palpate",
                                      "fit",
                                      head_file_.string(),
                                      "--landmark-file",
                                      points,
                                      "-o",
                                      (run_->folder / "fit.glb").string(),
                                      "--page",
                                      std::to_string(getpid())};
    const json options =
        head_.provenance.is_object() ? head_.provenance.value("options", json()) : json();
    for (const auto& [key, flag] :
         {std::pair{"edge_mm", "--edge"}, {"clearance_mm", "--clearance"}})
      if (options.is_object() && options.contains(key) && options[key].is_number())
        words.insert(words.end(), {flag, options[key].dump()});
    for (const auto& [key, flag] : {std::pair{"landmarks", "--landmarks"}, {"fit", "--fit"}})
      if (options.is_object() && options.contains(key) && options[key] == "published")
        words.insert(words.end(), {flag, "published"});
    run_->process = std::make_unique<ChildProcess>("/proc/self/exe", std::move(words));
  } catch (const std::runtime_error&) {
    stop_run();
    throw;
  }
  note_ = nullptr;
  for (const auto& [name, p] : request.moved) run_->moved[name] = numbers(p);
  post();
}

void PointsDesk::stop_run() {
  if (!run_) return;
  run_->process.reset();  // killed, and gone before its folder goes
  std::error_code ignored;
  fs::remove_all(run_->folder, ignored);
  run_.reset();
}

void PointsDesk::read_run(serve::Server& server) {
  const std::optional<int> code = run_->process->ended();  // first, so that no line is missed
  for (const std::string& line : run_->process->lines()) hear(line);
  if (code) return finish_run(server, *code);
  constexpr double kEach = 0.25;  // [s]
  if (now_s() - posted_ > kEach) post();
}

/// "@ FRACTION STAGE", or words for people.
void PointsDesk::hear(const std::string& line) {
  if (!line.starts_with("@ ")) {
    if (!line.empty()) run_->last_line = line;
    return;
  }
  const std::size_t gap = line.find(' ', 2);
  if (gap == std::string::npos) return;
  const std::string stage = line.substr(gap + 1);
  const double fraction = std::strtod(line.c_str() + 2, nullptr);
  run_->stage = stage;
  const auto expected = run_->expected.find(stage);
  if (expected == run_->expected.end()) return;  // a step within a stage
  if (fraction <= 0) run_->stage_started = now_s();
  if (fraction < 1) return;
  run_->done_expected += expected->second;
  run_->done_taken += now_s() - run_->stage_started;
  run_->stage_started = now_s();
  run_->expected.erase(expected);
}

void PointsDesk::finish_run(serve::Server& server, int code) {
  const std::string last = run_->last_line;
  const double seconds = now_s() - run_->started;
  json moved = run_->moved;
  try {
    if (code == 0)
      server.publish(kFitPath,
                     {read_file(run_->folder / "fit.glb"), serve::content_type("fit.glb")});
  } catch (const std::runtime_error& problem) {
    stop_run();
    return note("failed", problem.what());
  }
  stop_run();
  if (code != 0) {
    constexpr std::string_view kName = "palpate: ";
    const std::string why = last.starts_with(kName) ? last.substr(kName.size()) : last;
    const bool told = code == kInput || code == kSolve;
    return note("failed", fmt::format("no skull with these points: {}",
                                      told ? why : fmt::format("the fit ended with {}", code)));
  }
  fit_["number"] = ++fits_;
  fit_["path"] = fmt::format("{}?{}", kFitPath, fits_);
  fit_["moved"] = std::move(moved);
  say_(fmt::format("skull fitted with the page's points in {:.0f} s", seconds));
  note("fitted", fmt::format("fitted in {:.0f} s", seconds));
}

void PointsDesk::note(const std::string& kind, const std::string& text) {
  note_ = {{"number", ++notes_}, {"kind", kind}, {"text", text}};
  post();
}

void PointsDesk::post() {
  posted_ = now_s();
  json run;
  if (run_) {
    // The stages left at the pace so far, less what has passed of the present one.
    const double pace = run_->done_expected > 0.1
                            ? std::clamp(run_->done_taken / run_->done_expected, 0.2, 20.0)
                            : 1.0;
    double left = 0;
    for (const auto& [stage, seconds] : run_->expected) left += pace * seconds;
    const double in_stage = posted_ - run_->stage_started;
    run_->left = std::max(left - in_stage, 0.0);
    const double passed = posted_ - run_->started;
    run = {{"stage", run_->stage},
           {"left_s", run_->left},
           {"fraction", passed / std::max(passed + run_->left, 1e-3)}};
  }
  json names = json::array();
  for (const std::string& name : names_) names.push_back(name);
  channel_.post(json{{"type", "points"},
                     {"names", names},
                     {"file", file_.string()},
                     {"saved", saved_},
                     {"no_fit", no_fit_because(head_.provenance)},
                     {"command", build_command_line(head_file_, head_.provenance)},
                     {"note", note_},
                     {"run", run},
                     {"fit", fits_ > 0 ? fit_ : json()}}
                    .dump(-1, ' ', false, json::error_handler_t::replace));
}

}  // namespace palpate::app
