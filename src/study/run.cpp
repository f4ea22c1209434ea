// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.hpp"
#include "study/random.hpp"

namespace palpate::study {
namespace {

/// Walks through the protocol and stops at the first screen without an answer.
class Walk {
 public:
  Walk(const Protocol& protocol, const Draw& draw, const Answers& answers)
      : protocol_(protocol), draw_(draw), answers_(answers) {}

  Screen next() {
    for (const Part& part : protocol_.parts) {
      walk(part);
      if (found_) return *found_;
    }
    Screen end;
    end.kind = ScreenKind::finished;
    end.key = "finished";
    end.title = "Thank you";
    end.text = "The study is over. Please tell the experimenter.";
    return end;
  }

 private:
  /// True when the screen was answered.
  bool past(Screen screen) {
    if (found_) return false;
    if (answers_.contains(screen.key)) return true;
    found_ = std::move(screen);
    return false;
  }
  [[nodiscard]] const std::string& value(const std::string& key) const { return answers_.at(key); }

  static Screen screen(const Part& part, ScreenKind kind, const std::string& rest) {
    Screen s;
    s.kind = kind;
    s.part = part.id;
    s.key = part.id + "/" + rest;
    s.title = part.title;
    return s;
  }
  static Screen question(const Part& part, const std::string& rest, const Question& q) {
    Screen s = screen(part, ScreenKind::question, rest);
    s.question = q;
    return s;
  }
  void excuse(const Part& part, const std::string& text) {
    Screen s = screen(part, ScreenKind::excused, "excused");
    s.text = text;
    found_ = std::move(s);
  }
  [[nodiscard]] const std::vector<std::string>& order(const Part& part, int round) const {
    for (const PlannedOrder& o : draw_.orders)
      if (o.part == part.id && o.round == round) return o.regions;
    throw InputError(fmt::format("no order was drawn for part {}", part.id));
  }
  Screen touch(const Part& part, const std::string& rest, int place,
               const std::vector<std::string>& regions) const {
    Screen s = screen(part, ScreenKind::touch, rest);
    s.place = place;
    s.places = static_cast<int>(regions.size());
    s.region = regions[static_cast<std::size_t>(place - 1)];
    s.least_s = part.least_s;
    s.most_s = part.most_s;
    s.head_visible = part.head_visible;
    return s;
  }

  void walk(const Part& part) {
    if (part.kind == PartKind::consent) return consent(part);
    if (!part.text.empty()) {
      Screen s = screen(part, ScreenKind::text, "begin");
      s.text = part.text;
      if (!past(std::move(s))) return;
    }
    switch (part.kind) {
      case PartKind::consent:
        return;
      case PartKind::questions:
        for (const Question& q : part.questions)
          if (!past(question(part, q.id, q))) return;
        return;
      case PartKind::tutorial:
        return tutorial(part);
      case PartKind::experiment:
        return experiment(part);
      case PartKind::discrimination:
        return discrimination(part);
    }
  }

  void consent(const Part& part) {
    Screen s = screen(part, ScreenKind::consent, "given");
    s.text = part.text;
    const std::string key = s.key;
    if (past(std::move(s)) && value(key) != "given")
      excuse(part, "You did not consent, so the study ends here. Nothing else was asked or kept.");
  }

  // Felt once; who could tell no difference may feel everything once more, and is excused after
  // that.
  void tutorial(const Part& part) {
    if (!feel(part, "")) return;
    if (part.gate.text.empty() || !past(question(part, "gate", part.gate))) return;
    if (value(part.id + "/gate") == "yes") return;
    if (!feel(part, "again/")) return;
    if (!past(question(part, "gate-again", part.gate_again))) return;
    if (value(part.id + "/gate-again") != "yes") excuse(part, part.excused);
  }
  bool feel(const Part& part, const std::string& prefix) {
    for (int round = 1; round <= static_cast<int>(part.orders.size()); ++round) {
      const auto& regions = order(part, round);
      for (int place = 1; place <= static_cast<int>(regions.size()); ++place) {
        Screen s = touch(part, fmt::format("{}{}/{}", prefix, round, place), place, regions);
        s.round = round;
        if (!past(std::move(s))) return false;
      }
    }
    return true;
  }

  void experiment(const Part& part) {
    const auto& regions = order(part, 1);
    for (int place = 1; place <= static_cast<int>(regions.size()); ++place) {
      const std::string here = fmt::format("{}", place);
      if (!past(touch(part, here, place, regions))) return;
      if (!part.where.text.empty() && !ask(part, here + "/where", part.where, place)) return;
      if (!ask(part, here + "/rating", part.rating, place)) return;
    }
    choose(part, "toughest", part.toughest, regions.size());
    choose(part, "softest", part.softest, regions.size());
  }
  bool ask(const Part& part, const std::string& rest, const Question& q, int place) {
    Screen s = question(part, rest, q);
    s.place = place;
    s.places = static_cast<int>(part.regions.size());
    s.head_visible = part.head_visible;  // the picture stays while its place is asked about
    return past(std::move(s));
  }
  void choose(const Part& part, const std::string& which, int count, std::size_t places) {
    if (count == 0 || found_) return;
    Screen s = screen(part, ScreenKind::choose, which);
    s.choose = count;
    s.places = static_cast<int>(places);
    s.text = fmt::format("Which {} of the places felt {}?", count, which);
    const auto other = answers_.find(part.id + "/toughest");
    if (which == "softest" && other != answers_.end())
      for (std::size_t from = 0; from < other->second.size();) {
        const std::size_t comma = std::min(other->second.find(',', from), other->second.size());
        s.barred.push_back(std::stoi(other->second.substr(from, comma - from)));
        from = comma + 1;
      }
    past(std::move(s));
  }

  // One staircase per region, one after the other. Each trial presses the same place twice, once as
  // the map has it and once stiffer.
  void discrimination(const Part& part) {
    const auto& regions = order(part, 1);
    for (std::size_t series = 0; series < regions.size(); ++series)
      if (!staircase(part, static_cast<int>(series + 1), regions[series])) return;
  }
  bool staircase(const Part& part, int series, const std::string& region) {
    std::vector<bool> right;
    while (true) {
      const StaircaseState state = staircase_after(part.staircase, right);
      if (state.over) return true;
      const int trial = state.trials + 1;
      const std::string base = fmt::format("{}/{}", series, trial);
      Random chance(draw_.seed, "stiffer/" + part.id + "/" + base,
                    static_cast<std::uint64_t>(draw_.order_index));
      const int stiffer = 1 + static_cast<int>(chance.below(2));
      for (const int interval : {1, 2}) {
        Screen s = touch(part, fmt::format("{}/{}", base, interval), 1, {region});
        s.place = trial;
        s.places = 0;
        s.interval = interval;
        s.factor = interval == stiffer ? 1 + state.difference : 1;
        if (!past(std::move(s))) return false;
      }
      Screen which = question(part, base + "/stiffer", which_question());
      which.place = trial;
      which.factors[static_cast<std::size_t>(stiffer - 1)] = 1 + state.difference;
      if (!past(std::move(which))) return false;
      right.push_back(value(part.id + "/" + base + "/stiffer") == fmt::format("{}", stiffer));
    }
  }
  static Question which_question() {
    Question q;
    q.id = "stiffer";
    q.type = QuestionType::choice;
    q.text = "Which of the two felt stiffer?";
    q.options = {{"1", "the first"}, {"2", "the second"}};
    return q;
  }

  const Protocol& protocol_;
  const Draw& draw_;
  const Answers& answers_;
  std::optional<Screen> found_;
};

std::string checked_number(const Question& q, const std::string& value) {
  double x = 0;
  const char* end = value.data() + value.size();
  const auto read = std::from_chars(value.data(), end, x);
  if (read.ec != std::errc{} || read.ptr != end || !(x >= q.least && x <= q.most))
    throw InputError(fmt::format("Please give a number from {} to {}.", q.least, q.most));
  const double steps = (x - q.least) / q.step;
  if (std::abs(steps - std::round(steps)) > 1e-6)
    throw InputError(fmt::format("Please give a number in steps of {}.", q.step));
  return fmt::format("{}", q.least + std::round(steps) * q.step);
}

std::string checked_question(const Question& q, const std::string& value) {
  if (value.empty()) {
    if (q.optional) return value;
    throw InputError("Please answer before you go on.");
  }
  switch (q.type) {
    case QuestionType::choice:
      for (const Option& option : q.options)
        if (option.id == value) return value;
      throw InputError("Please choose one of the answers.");
    case QuestionType::number:
    case QuestionType::rating:
      return checked_number(q, value);
    case QuestionType::text:
      break;
  }
  constexpr std::size_t kLongest = 4000;  // [byte]
  if (value.size() > kLongest)
    throw InputError(fmt::format("Please keep to {} characters.", kLongest));
  return value;
}

std::string checked_choice(const Screen& screen, const std::string& value) {
  std::vector<int> places;
  for (std::size_t from = 0; from < value.size();) {
    const std::size_t comma = std::min(value.find(',', from), value.size());
    int place = 0;
    const auto read = std::from_chars(value.data() + from, value.data() + comma, place);
    if (read.ec != std::errc{} || read.ptr != value.data() + comma || place < 1 ||
        place > screen.places)
      throw InputError(fmt::format("Please choose numbers from 1 to {}.", screen.places));
    if (std::find(screen.barred.begin(), screen.barred.end(), place) != screen.barred.end())
      throw InputError(fmt::format("You have chosen {} as one of the toughest already.", place));
    places.push_back(place);
    from = comma + 1;
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  if (static_cast<int>(places.size()) != screen.choose)
    throw InputError(fmt::format("Please choose {}.", screen.choose));
  return fmt::format("{}", fmt::join(places, ","));
}

}  // namespace

Screen next_screen(const Protocol& protocol, const Draw& draw, const Answers& answers) {
  return Walk(protocol, draw, answers).next();
}

std::string checked_value(const Screen& screen, const std::string& value) {
  switch (screen.kind) {
    case ScreenKind::text:
    case ScreenKind::touch:
      return "done";
    case ScreenKind::consent:
      if (value == "given" || value == "refused") return value;
      throw InputError("Please say whether you consent.");
    case ScreenKind::question:
      return checked_question(screen.question, value);
    case ScreenKind::choose:
      return checked_choice(screen, value);
    case ScreenKind::finished:
    case ScreenKind::excused:
      break;
  }
  throw InputError("The study is over; nothing is left to answer.");
}

StaircaseState staircase_after(const Staircase& o, const std::vector<bool>& right) {
  StaircaseState s;
  s.difference = o.start;
  int in_a_row = 0, direction = 0;
  for (const bool correct : right) {
    ++s.trials;
    int move = 0;
    if (!correct) {
      move = 1;
      in_a_row = 0;
    } else if (++in_a_row == o.correct_for_down) {
      move = -1;
      in_a_row = 0;
    }
    if (move == 0) continue;
    if (direction != 0 && move != direction) ++s.reversals;
    direction = move;
    constexpr int kCoarse = 2;  // reversals after which the steps are fine
    const double step = s.reversals < kCoarse ? o.step : o.fine_step;
    s.difference =
        std::clamp(move > 0 ? s.difference * step : s.difference / step, o.least, o.most);
  }
  s.over = s.reversals >= o.reversals || s.trials >= o.most_trials;
  return s;
}

}  // namespace palpate::study
