// SPDX-License-Identifier: GPL-3.0-or-later
// A study's protocol: what is asked and touched, in which order (docs/study.md, own protocols).
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::study {

enum class QuestionType : std::uint8_t { choice, number, text, rating };

struct Option {
  std::string id;    ///< what is stored: letters, digits, '-'
  std::string text;  ///< what is read
};

struct Question {
  std::string id;
  QuestionType type = QuestionType::text;
  std::string text;
  std::vector<Option> options;  ///< choice
  double least = 1, most = 10;  ///< number and rating
  double step = 1;              ///< number and rating: answers are least + n step
  std::string low, high;        ///< rating: words at the two ends
  bool optional = false;        ///< may be left empty
};

enum class PartKind : std::uint8_t { consent, questions, tutorial, experiment, discrimination };
enum class OrderKind : std::uint8_t {
  random,     ///< drawn for each participant
  balanced,   ///< Williams square: each place follows each other one equally often
  stiffness,  ///< as the head has it, stiff to soft
};

/// Adaptive staircase of a two-interval forced choice; works on the difference of stiffness.
struct Staircase {
  double start = 0.6;        ///< [-] first difference; the stiffer is (1 + d) times the softer
  double least = 0.01;       ///< [-] 0 < least < start
  double most = 1.5;         ///< [-] > start
  double step = 1.6;         ///< [-] factor between levels until the second reversal; > 1
  double fine_step = 1.25;   ///< [-] factor after it; > 1
  int correct_for_down = 3;  ///< right answers in a row that make it harder: 3 -> 79.4 % correct
  int reversals = 10;        ///< it ends after so many
  int most_trials = 80;      ///< or after so many trials
};

struct Part {
  std::string id;
  PartKind kind = PartKind::questions;
  std::string title;
  std::string text;                  ///< shown before the part begins
  std::vector<Question> questions;   ///< questions
  std::vector<OrderKind> orders;     ///< tutorial: one per round; experiment: one
  std::vector<std::string> regions;  ///< that this part touches; by default the protocol's
  double least_s = 0, most_s = 0;    ///< [s] touch: not earlier, not later; most 0: no end
  bool head_visible = false;         ///< touch and sight
  Question rating;                   ///< experiment: after each place
  Question where;                    ///< experiment with `describe`; its text empty where not asked
  int toughest = 0, softest = 0;     ///< experiment: how many are chosen at its end
  Question gate, gate_again;  ///< tutorial: may the participant go on; after a second tutorial
  std::string excused;        ///< tutorial: what is said to who may not
  Staircase staircase;        ///< discrimination
};

/// What the analysis compares with.
struct Analysis {
  std::string group;                         ///< "background/haptic-experience"; empty: no groups
  std::vector<std::string> reference_order;  ///< regions, stiff to soft; empty: no ranking
  std::string touch_only, touch_and_sight;   ///< ids of the two experiments; empty where missing
  std::string rationality;                   ///< "rationality/realism"; empty: none
  double rationality_reference = 8;
};

struct Protocol {
  std::string name;  ///< "head-stiffness-2015"
  std::string title;
  std::string source;    ///< who did it first; empty for none
  int participants = 1;  ///< planned
  std::vector<std::string> regions;
  std::vector<Part> parts;
  Analysis analysis;
  std::string text;  ///< the TOML itself
};

/// @throws InputError  file, line, what is wrong and what would be right: unknown and misspelt
/// keys,
///                     missing ones, wrong types, numbers out of range, regions and ids that do not
///                     exist or appear twice
[[nodiscard]] Protocol parse_protocol(std::string_view toml, const std::string& file_name);
[[nodiscard]] Protocol read_protocol(const std::filesystem::path& path);

}  // namespace palpate::study
