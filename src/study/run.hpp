// SPDX-License-Identifier: GPL-3.0-or-later
// What comes next: a pure function of the protocol, the drawn orders and the answers so far. The
// answers are the whole state of a run, so a run goes on wherever the last answer was committed.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/protocol.hpp"
#include "study/store.hpp"

namespace palpate::study {

enum class ScreenKind : std::uint8_t {
  text,      ///< read, then go on
  consent,   ///< given or refused
  question,  ///< one question
  touch,     ///< touch one place for a time
  choose,    ///< some of the places, by number
  finished,
  excused,  ///< consent refused, or a tutorial's gate not passed
};

struct Screen {
  ScreenKind kind = ScreenKind::text;
  std::string key;   ///< unique in the run: "touch/3", "touch/3/rating", "touch/toughest"
  std::string part;  ///< id of the part
  std::string title;
  std::string text;
  Question question;   ///< question
  int place = 0;       ///< touch and what is asked about it: 1-based, as the participant counts
  int places = 0;      ///< touch: of so many; 0 where it is not known (discrimination)
  int round = 0;       ///< tutorial: 1-based
  int interval = 0;    ///< discrimination: 1 or 2
  std::string region;  ///< touch: never for a participant's eyes
  double factor = 1;   ///< [-] touch: stiffness over the map's; never for a participant's eyes
  /// [-] discrimination, when asked which: of the two presses. Never for a participant's eyes.
  std::array<double, 2> factors{1, 1};
  double least_s = 0;  ///< [s] touch
  double most_s = 0;   ///< [s] touch; 0: no end
  bool head_visible = false;
  int choose = 0;           ///< choose: how many
  std::vector<int> barred;  ///< choose: places that may not be chosen
};

/// Screen's key -> value, as stored.
using Answers = std::map<std::string, std::string>;

/// What was drawn for one participant.
struct Draw {
  std::vector<PlannedOrder> orders;
  std::uint64_t seed = 0;  ///< of the study; decides which interval is the stiffer one
  int order_index = 0;
};

/// @throws InputError  the orders lack a part of the protocol
[[nodiscard]] Screen next_screen(const Protocol& protocol, const Draw& draw,
                                 const Answers& answers);

/// The value as it is stored. Text and touch screens take any word and store "done".
/// @throws InputError  what is wrong, in one line for the participant
[[nodiscard]] std::string checked_value(const Screen& screen, const std::string& value);

// --- orders

/// Rounds of orders that a part draws: one per tutorial round, one of an experiment, one for the
/// regions of a discrimination.
[[nodiscard]] int rounds_of(const Part& part);
/// Rows in which each of 0 ... n-1 stands in each place equally often and follows each other one
/// equally often: n rows for even n, 2n for odd (E. J. Williams, 1949). n >= 1.
[[nodiscard]] std::vector<std::vector<int>> balanced_rows(int n);
/// @param regions  with the head's stiffness, for tutorials from stiff to soft
[[nodiscard]] std::vector<PlannedOrder> draw_orders(const Protocol& protocol,
                                                    std::span<const StudyRegion> regions,
                                                    std::uint64_t seed, int order_index);

// --- staircase

struct StaircaseState {
  double difference = 0;  ///< [-] of the next trial
  int trials = 0;
  int reversals = 0;
  bool over = false;
};
/// After the answers so far, right or wrong. The difference grows after each wrong one and shrinks
/// after `correct_for_down` right ones in a row (H. Levitt, 1971).
[[nodiscard]] StaircaseState staircase_after(const Staircase& options,
                                             const std::vector<bool>& right);

}  // namespace palpate::study
