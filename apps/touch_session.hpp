// SPDX-License-Identifier: GPL-3.0-or-later
// A head that is being touched: model, device, loop, recorder, page, put together and run.
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/progress.hpp"
#include "haptics/tick.hpp"

namespace palpate::app {

struct TouchOptions {
  std::filesystem::path head;
  /// "auto", "pointer", "simulated", "simulated:falcon" or what haptics::open_device() takes
  std::string device = "auto";
  double rate_hz = 1000;           ///< [Hz] of the loop
  int priority = 80;               ///< SCHED_FIFO; 0 asks for nothing
  double tool_radius = 0;          ///< [mm] 0: the map's
  std::string region;              ///< where the device's workspace is put; empty: the face
  std::string preset = "default";  ///< "published": the Falcon's row at 8.7 N
  double workspace_scale = 1;      ///< [-] millimetres of head per millimetre of device
  haptics::TickOptions tick;
  std::filesystem::path record;  ///< empty: none
  std::string address = "127.0.0.1";
  int port = 0;              ///< 0: 8733, or a free one where that is taken
  std::string token;         ///< empty beyond loopback: one is made up
  bool page = true;          ///< false: no server
  bool open_browser = true;  ///< where there is a screen
  double seconds = 0;        ///< [s] ends by itself; 0: at Ctrl-C
};

/// Serves and touches until the time is over or the user stops; gives the report.
/// @param say  gets lines for people as they come: address, device, warnings
/// @throws InputError, FileError
[[nodiscard]] nlohmann::json run_touch(const TouchOptions& options, const Progress& stop,
                                       const std::function<void(const std::string&)>& say);

/// Folder of the built page: $PALPATE_WEB, else web/ beside the program, else ../share/palpate/web;
/// empty where there is none.
[[nodiscard]] std::filesystem::path page_folder();

}  // namespace palpate::app
