// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/runner.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"

namespace palpate::study {
namespace {

constexpr std::size_t kBlock = 500;  // samples: half a second at 1 kHz
constexpr std::int64_t kBlockUs = 500'000;

/// "touch/3" of "touch/3/rating"; empty where the screen is not about a place.
std::string touched_key(const Screen& screen) {
  if (screen.kind != ScreenKind::question || screen.place == 0) return {};
  return screen.key.substr(0, screen.key.rfind('/'));
}

}  // namespace

Runner::Runner(Store& store, const Protocol& protocol, const std::string& pseudonym)
    : store_(store), protocol_(protocol), pseudonym_(pseudonym) {
  load();
  session_ = store_.begin_session(pseudonym_);
  if (!over()) store_.set_state(pseudonym_, ParticipantState::running);
}

Runner::~Runner() {
  try {
    flush();
    store_.end_session(session_);
  } catch (const std::exception&) {
    // The session then counts as cut short, which it was.
  }
}

void Runner::load() {
  const auto people = store_.participants();
  const auto who = std::find_if(people.begin(), people.end(),
                                [&](const Participant& p) { return p.pseudonym == pseudonym_; });
  if (who == people.end()) throw InputError(fmt::format("there is no participant {}", pseudonym_));
  if (who->state == ParticipantState::withdrawn)
    throw InputError(fmt::format("{} has withdrawn; their data are gone", pseudonym_));
  draw_ = {store_.plan(pseudonym_), store_.study().seed, who->order_index};
  for (const Answer& a : store_.answers(pseudonym_)) answers_[a.key] = a.value;
  screen_ = next_screen(protocol_, draw_, answers_);
  asked_ = now();
  const std::string about = touched_key(screen_);
  if (about.empty()) return;
  for (const TrialRecord& t : store_.trials())
    if (t.pseudonym == pseudonym_ && t.key == about) trial_ = t.id;
}

void Runner::begin_trial() {
  TrialRecord t;
  t.pseudonym = pseudonym_;
  t.experiment = screen_.part;
  t.key = screen_.key;
  t.index = screen_.place;
  t.region = screen_.region;
  t.head_visible = screen_.head_visible;
  t.factor = screen_.factor;
  t.interval = screen_.interval;
  trial_ = store_.begin_trial(session_, t);
  touching_ = true;
  touched_s_ = 0;
  any_samples_ = false;
}

bool Runner::pass(double seconds) {
  if (screen_.kind != ScreenKind::touch || paused_) return false;
  if (!touching_) begin_trial();
  touched_s_ += seconds;
  if (screen_.most_s == 0 || touched_s_ < screen_.most_s) return false;
  commit("done");
  return true;
}

bool Runner::may_go_on() const {
  return screen_.kind != ScreenKind::touch || touched_s_ >= screen_.least_s;
}

void Runner::add_samples(std::span<const HapticSample> samples) {
  if (!touching_) return;
  for (HapticSample s : samples) {
    if (!any_samples_) first_us_ = s.time_us;
    any_samples_ = true;
    s.time_us -= first_us_;
    buffer_.push_back(s);
    if (buffer_.size() >= kBlock || s.time_us - buffer_.front().time_us >= kBlockUs) flush();
  }
}

void Runner::flush() {
  if (!touching_ || buffer_.empty()) return;
  store_.add_samples(trial_, buffer_);
  buffer_.clear();
}

void Runner::answer(const std::string& value) {
  if (paused_) throw InputError("The study is paused.");
  if (screen_.kind == ScreenKind::touch && !may_go_on())
    throw InputError(fmt::format("Please feel for {:.0f} seconds more.",
                                 std::max(1.0, screen_.least_s - touched_s_)));
  const std::string checked = checked_value(screen_, value);
  if (screen_.kind == ScreenKind::touch && !touching_) begin_trial();
  commit(checked);
}

void Runner::commit(const std::string& value) {
  if (touching_) {
    flush();
    store_.end_trial(trial_);
    touching_ = false;
  }
  Answer a;
  a.pseudonym = pseudonym_;
  a.key = screen_.key;
  a.value = value;
  a.asked = asked_;
  a.answered = std::max(asked_, now());
  store_.add_answer(session_, screen_.place > 0 ? trial_ : 0, a);
  answers_[a.key] = value;
  touched_s_ = 0;
  screen_ = next_screen(protocol_, draw_, answers_);
  asked_ = now();
  if (screen_.kind == ScreenKind::finished)
    store_.set_state(pseudonym_, ParticipantState::finished);
  if (screen_.kind == ScreenKind::excused) store_.set_state(pseudonym_, ParticipantState::excused);
}

void Runner::pause(bool on) {
  if (on == paused_) return;
  paused_ = on;
  store_.add_event(pseudonym_, on ? "pause" : "resume", screen_.key);
}

}  // namespace palpate::study
