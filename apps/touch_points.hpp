// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks that the page moves: kept in a text file beside the head, and fitted anew by a run of
// this program in the background (docs/method/page.md).
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "apps/child_process.hpp"
#include "core/touchable_head.hpp"
#include "haptics/touch_model.hpp"
#include "serve/points.hpp"
#include "serve/server.hpp"

namespace palpate::app {

/// <head>.landmarks.txt beside the head.
[[nodiscard]] std::filesystem::path points_file(const std::filesystem::path& head);

/// The whole map again with the points of the file, as it would be typed: options that the head
/// was not built with the defaults of are written out.
[[nodiscard]] std::string build_command_line(const std::filesystem::path& head,
                                             const nlohmann::json& provenance);

/// Why a fit in the background would not be the head's own; empty where it would.
[[nodiscard]] std::string no_fit_because(const nlohmann::json& provenance);

/// For one thread, which is not the touch loop's.
class PointsDesk {
 public:
  using Say = std::function<void(const std::string&)>;
  /// @param head, model  outlive the desk
  /// @param say  gets a line for each file written and each run
  PointsDesk(const TouchableHead& head, const haptics::TouchModel& model,
             std::filesystem::path head_file, Say say);
  ~PointsDesk();  ///< ends a run and removes what it made
  PointsDesk(const PointsDesk&) = delete;
  PointsDesk& operator=(const PointsDesk&) = delete;

  [[nodiscard]] serve::Channel& channel() { return channel_; }
  /// Does what pages have asked since the last call, and looks after the run. Never waits.
  void look(serve::Server& server);

 private:
  struct Run {
    std::filesystem::path folder;
    std::unique_ptr<ChildProcess> process;
    std::map<std::string, double> expected;  // [s] per stage left
    double started = 0, stage_started = 0;   // [s]
    double done_expected = 0, done_taken = 0;
    nlohmann::json moved = nlohmann::json::object();  // points that it was started with
    std::string stage, last_line;
    double left = 0;  // [s]
  };

  void apply(const serve::PointsRequest& request);
  void save(const serve::PointsRequest& request);
  void start(const serve::PointsRequest& request);
  void stop_run();
  void read_run(serve::Server& server);
  void hear(const std::string& line);
  void finish_run(serve::Server& server, int code);
  void load_saved();
  [[nodiscard]] std::string text_of(const std::map<std::string, Vec3>& moved) const;
  void note(const std::string& kind, const std::string& text);
  void post();

  const TouchableHead& head_;
  const haptics::TouchModel& model_;
  std::filesystem::path head_file_, file_;
  Say say_;
  serve::Channel channel_;
  std::set<std::string> names_;
  std::string written_;                // what this desk wrote last; empty: nothing
  nlohmann::json saved_, note_, fit_;  // as pages get them
  int notes_ = 0, fits_ = 0;
  std::optional<Run> run_;
  double posted_ = 0;  // [s]
};

}  // namespace palpate::app
