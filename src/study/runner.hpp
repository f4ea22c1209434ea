// SPDX-License-Identifier: GPL-3.0-or-later
// One participant's way through a study: each answer is committed before the next screen shows.
#pragma once
#include <span>
#include <string>

#include "study/run.hpp"

namespace palpate::study {

/// Takes up a participant wherever their last answer was. Time is told from outside, so that a
/// study runs as well at the speed of the machine as at that of people.
class Runner {
 public:
  /// Begins a session. `store` and `protocol` outlive the runner.
  /// @throws InputError  there is no such participant, or they have withdrawn
  Runner(Store& store, const Protocol& protocol, const std::string& pseudonym);
  ~Runner();  ///< ends the session; samples not yet in a block are written
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  [[nodiscard]] const std::string& pseudonym() const { return pseudonym_; }
  [[nodiscard]] const Screen& screen() const { return screen_; }
  [[nodiscard]] const Answers& answers() const { return answers_; }
  [[nodiscard]] const Draw& draw() const { return draw_; }
  [[nodiscard]] bool over() const {
    return screen_.kind == ScreenKind::finished || screen_.kind == ScreenKind::excused;
  }

  /// Commits the answer and moves on.
  /// @throws InputError  it cannot be, it is too early, or the run is paused; nothing was written
  void answer(const std::string& value);

  /// `seconds` of touch went by; the first call on a touch screen begins its trial. No effect while
  /// paused or on another screen. Moves on by itself at the screen's last second.
  /// @return true when it moved on
  bool pass(double seconds);
  /// Ticks of the running trial, in order; their times count from anywhere. At least once in half
  /// a second, so that a kill loses no more than that and a block's writing.
  void add_samples(std::span<const HapticSample> samples);
  [[nodiscard]] double touched_s() const { return touched_s_; }
  [[nodiscard]] bool may_go_on() const;

  void pause(bool on);
  [[nodiscard]] bool paused() const { return paused_; }
  [[nodiscard]] std::int64_t trial() const { return trial_; }

 private:
  void load();
  void begin_trial();
  void flush();
  void commit(const std::string& value);

  Store& store_;
  const Protocol& protocol_;
  std::string pseudonym_;
  Draw draw_;
  Answers answers_;
  Screen screen_;
  std::int64_t session_ = 0;
  std::int64_t trial_ = 0;  // the running one, or the last of the place that is asked about
  bool touching_ = false;
  bool paused_ = false;
  double touched_s_ = 0;
  Moment asked_ = 0;
  std::int64_t first_us_ = 0;  // of the trial's samples
  std::vector<HapticSample> buffer_;
  bool any_samples_ = false;
};

}  // namespace palpate::study
