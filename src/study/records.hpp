// SPDX-License-Identifier: GPL-3.0-or-later
// What a study file holds, as plain nouns (docs/formats.md, study file). People are pseudonyms
// only: there is no field that a name could go into.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"

namespace palpate::study {

/// [ms] since 1970-01-01 UTC; 0 where it did not happen.
using Moment = std::int64_t;

inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// A place that is touched, as the head had it when the study was made.
struct StudyRegion {
  std::string name;             ///< as in core/regions.hpp
  double stiffness = kNothing;  ///< [N/mm] median of the region's map: 2 N / u(2 N)
  /// [N/mm] the map at `point` itself: 2 N / u(2 N). What correlations use.
  double stiffness_at_point = kNothing;
  Vec3 point = Vec3::Zero();    ///< [mm] head frame; lies at the workspace's middle in a trial
  Vec3 normal = Vec3::UnitZ();  ///< [-] outward; turned towards the user
};

/// One file is one study of one head by one protocol.
struct Study {
  std::string id;             ///< 32 hexadecimal digits
  std::string title;          ///< of the protocol
  std::string protocol_name;  ///< "head-stiffness-2015"
  std::string protocol_text;  ///< the TOML as it was, comments included; parse_protocol() reads it
  std::string head_name;      ///< file name without folders
  std::string head_fingerprint;
  double tool_radius = 0;  ///< [mm]
  std::uint64_t seed = 0;  ///< of all orders
  std::string program;     ///< "palpate 0.1.0"
  Moment created = 0;
  int planned_participants = 0;
  bool simulated = false;            ///< some participant is a program
  std::string simulation;            ///< JSON of its settings; empty where nobody is simulated
  std::vector<StudyRegion> regions;  ///< in the protocol's order
};

enum class ParticipantState : std::uint8_t { enrolled, running, finished, excused, withdrawn };
inline constexpr std::array<std::string_view, 5> kParticipantStateNames = {
    "enrolled", "running", "finished", "excused", "withdrawn"};
[[nodiscard]] constexpr std::string_view name(ParticipantState s) {
  return kParticipantStateNames[static_cast<std::size_t>(s)];
}

struct Participant {
  std::int64_t id = 0;
  std::string pseudonym;  ///< "P001"
  int order_index = 0;    ///< 0, 1, ...: row of the balanced orders
  bool simulated = false;
  ParticipantState state = ParticipantState::enrolled;
  Moment enrolled = 0, ended = 0, withdrawn = 0;
  /// Answer to the protocol's group question ("experienced", "novice"); empty before it is given.
  std::string group;
  std::map<std::string, std::string> background;  ///< question id -> value
};

/// One stretch of work of a runner with a participant; a crash or a pause begins another.
struct Session {
  std::int64_t id = 0;
  std::string pseudonym;
  Moment started = 0;
  Moment ended = 0;  ///< 0: cut short
};

/// One place touched once. A trial that a crash cut is done again: the later attempt counts.
struct TrialRecord {
  std::int64_t id = 0;
  std::string pseudonym;
  std::string experiment;         ///< id of the protocol's part: "touch", "sight", "tutorial", ...
  std::string key;                ///< of the screen: "touch/3", "tutorial/2/5", "compare/12/1"
  int index = 0;                  ///< 1-based, as the participant counts it
  int attempt = 1;                ///< 1-based
  bool last_attempt = true;       ///< false: cut short and done again
  std::string region;             ///< name
  bool head_visible = false;      ///< touch and sight
  double factor = 1;              ///< [-] stiffness rendered over the map's (discrimination)
  int interval = 0;               ///< 1 or 2 in a discrimination, else 0
  Moment started = 0, ended = 0;  ///< ended 0: cut short
  double rating = kNothing;       ///< 1 to 10; NaN where not asked or not yet answered
  std::string description;        ///< "where is it", in the participant's words
};

/// The two toughest and the two softest of one experiment, as region names.
struct Choice {
  std::string pseudonym;
  std::string experiment;
  std::vector<std::string> toughest, softest;
};

/// One trial of a two-interval forced choice: which of two presses was stiffer?
struct Comparison {
  std::string pseudonym;
  std::string experiment;
  std::string region;
  int index = 0;          ///< 1-based
  double difference = 0;  ///< [-] the stiffer is (1 + difference) times the softer; > 0
  int stiffer = 1;        ///< interval that was stiffer: 1 or 2
  int answered = 1;
  [[nodiscard]] bool correct() const { return stiffer == answered; }
};

/// Everything that was ever asked and answered, in the order in which it was.
struct Answer {
  std::int64_t id = 0;
  std::string pseudonym;
  std::string key;   ///< of the screen: "background/age", "touch/3/rating", "rationality/realism"
  std::string part;  ///< "background"
  std::string question;  ///< what follows the last '/': "age", "rating"
  std::string value;     ///< as text; a choice gives the option's id
  Moment asked = 0, answered = 0;
};

/// One tick of the touch loop, head frame.
struct HapticSample {
  std::int64_t time_us = 0;      ///< since the trial's touch began
  Vec3 position = Vec3::Zero();  ///< [mm] of the tool's centre; kept to 0.1 um
  Vec3 force = Vec3::Zero();     ///< [N] on the hand; kept to 0.1 mN
  bool contact = false;
  std::uint8_t region = 0;  ///< SkinRegion under the tool
};

/// Up to a second of samples of one trial.
struct SampleBlock {
  std::int64_t trial = 0;  ///< TrialRecord::id
  int sequence = 0;        ///< 0, 1, ... within the trial
  std::size_t count = 0;
  double peak_force = 0;              ///< [N] largest |force|
  double contact_s = 0;               ///< [s] in contact
  std::size_t bytes = 0;              ///< as stored
  std::vector<HapticSample> samples;  ///< empty where only the summary was read
};

/// What happened around the answers: pause, resume, crash, withdrawal, notes of the program.
struct Event {
  Moment time = 0;
  std::string pseudonym;  ///< empty: the study
  std::string kind;
  std::string detail;
};

}  // namespace palpate::study
