// SPDX-License-Identifier: GPL-3.0-or-later
// A study that is being run: file, head, protocol and participants, put together.
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/progress.hpp"
#include "haptics/touch_model.hpp"
#include "study/simulated_participant.hpp"

namespace palpate::app {

struct StudyOptions {
  std::filesystem::path protocol, head, output;
  int participants = 0;    ///< 0: as many as the protocol plans
  std::uint64_t seed = 0;  ///< of a new study; 0 draws one
  bool simulate = false;   ///< all participants are programs, at the speed of the machine
  bool follow = false;     ///< say each committed answer
  study::SimulationOptions simulation;
  // live
  std::string device = "auto";  ///< "simulated", or what haptics::open_device() takes
  double rate_hz = 1000;
  int priority = 80;
  std::string address = "127.0.0.1";
  int port = 0;
  std::string token;
  bool open_browser = true;
  double seconds = 0;  ///< [s] ends by itself; 0: at Ctrl-C
};

using Say = std::function<void(const std::string&)>;

/// All that a run needs, checked before the first answer.
struct OpenStudy {
  study::Protocol protocol;
  haptics::TouchModel model;
  study::Study study;
  study::Store store;
  std::string skin;  ///< bytes of the picture's mesh: places and triangles, nothing else
};
/// Makes the study file, or goes on with the one that is there.
/// @throws InputError  the file is of another protocol or head, is damaged or in use, or its
///                     participants are people and --simulate was given (or the other way round)
[[nodiscard]] OpenStudy open_study(const StudyOptions& options);

/// Runs all participants that are not over. @return counts and times
[[nodiscard]] nlohmann::json run_simulated(OpenStudy& study, const StudyOptions& options,
                                           const Progress& progress, const Say& say);
/// Serves the two pages until the user stops.
[[nodiscard]] nlohmann::json run_live(OpenStudy& study, const StudyOptions& options,
                                      const Progress& stop, const Say& say);

}  // namespace palpate::app
