// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/atomic_file.hpp"
#include "core/regions.hpp"
#include "study/run.hpp"
#include "study/toml_reader.hpp"

namespace palpate::study {
namespace {

constexpr int kFormat = 1;
constexpr double kAny = 1e6;       // bound of numbers that a protocol may ask for
constexpr double kLongest = 3600;  // [s] of one touch
constexpr int kMostParticipants = 9999;

template <class T, std::size_t N>
T one_of(TomlTable& t, const std::string& key, const std::string& word,
         const std::array<std::pair<const char*, T>, N>& known) {
  std::vector<std::string> names;
  for (const auto& [name, value] : known) {
    if (word == name) return value;
    names.emplace_back(name);
  }
  t.refuse(key, fmt::format("{} is none of {}", word, fmt::join(names, ", ")));
}

std::string checked_id(TomlTable& t, const std::string& key, const std::string& id) {
  const bool fine = !id.empty() && std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
  if (!fine) t.refuse(key, fmt::format("'{}': use small letters, digits and '-'", id));
  return id;
}

void read_rating(TomlTable& t, Question& q) {
  q.type = QuestionType::rating;
  q.text = t.text("text");
  q.least = t.number("least", 1, -kAny, kAny);
  q.most = t.number("most", 10, -kAny, kAny);
  if (!(q.most > q.least)) t.refuse("most", fmt::format("expects more than {}", q.least));
  q.step = t.number("step", 1, 1e-3, q.most - q.least);
  q.low = t.text("low", "");
  q.high = t.text("high", "");
}

Question read_question(TomlTable t) {
  Question q;
  q.id = checked_id(t, "id", t.text("id"));
  t.name("question " + q.id);
  // What follows a touch has these names in the study file.
  for (const char* own : {"rating", "where", "toughest", "softest", "stiffer", "gate", "gate-again",
                          "begin", "excused", "given"})
    if (q.id == own) t.refuse("id", fmt::format("{} is used by the program; take another", own));
  constexpr std::array<std::pair<const char*, QuestionType>, 4> kTypes{
      {{"choice", QuestionType::choice},
       {"number", QuestionType::number},
       {"text", QuestionType::text},
       {"rating", QuestionType::rating}}};
  q.type = one_of(t, "type", t.text("type"), kTypes);
  q.optional = t.boolean("optional", false);
  if (q.type == QuestionType::rating) {
    read_rating(t, q);
  } else {
    q.text = t.text("text");
    if (q.type == QuestionType::number) {
      q.least = t.number("least", 0, -kAny, kAny);
      q.most = t.number("most", kAny, -kAny, kAny);
      if (!(q.most > q.least)) t.refuse("most", fmt::format("expects more than {}", q.least));
      q.step = t.number("step", 1, 1e-3, q.most - q.least);
    }
    if (q.type == QuestionType::choice) {
      for (TomlTable o : t.tables("options", "option of " + q.id)) {
        const std::string id = checked_id(o, "id", o.text("id"));
        if (std::any_of(q.options.begin(), q.options.end(), [&](auto& x) { return x.id == id; }))
          o.refuse("id", fmt::format("{} appears twice", id));
        q.options.push_back({id, o.text("text")});
        o.finish();
      }
      if (q.options.size() < 2) t.refuse("options", "expects two or more");
    }
  }
  t.finish();
  return q;
}

Question yes_or_no(const std::string& id, const std::string& text) {
  Question q;
  q.id = id;
  q.type = QuestionType::choice;
  q.text = text;
  q.options = {{"yes", "Yes"}, {"no", "No"}};
  return q;
}

std::vector<std::string> read_regions(TomlTable& t, const std::string& key,
                                      const std::vector<std::string>& allowed) {
  const auto regions = t.words(key);
  for (const std::string& r : regions)
    if (std::find(allowed.begin(), allowed.end(), r) == allowed.end())
      t.refuse(key,
               fmt::format("there is no region {}; there are {}", r, fmt::join(allowed, ", ")));
  return regions;
}

void read_orders(TomlTable& t, Part& part) {
  constexpr std::array<std::pair<const char*, OrderKind>, 3> kOrders{
      {{"random", OrderKind::random},
       {"balanced", OrderKind::balanced},
       {"stiffness", OrderKind::stiffness}}};
  if (part.kind == PartKind::tutorial) {
    for (const std::string& word : t.words("orders", true))
      part.orders.push_back(one_of(t, "orders", word, kOrders));
  } else {
    part.orders = {one_of(t, "order", t.text("order", "balanced"), kOrders)};
  }
}

void read_touch(TomlTable& t, Part& part, const Protocol& protocol) {
  part.regions = t.has("regions") ? read_regions(t, "regions", protocol.regions) : protocol.regions;
  read_orders(t, part);
  const auto seconds = t.numbers("seconds", 2, 0, kLongest);
  part.least_s = seconds[0];
  part.most_s = seconds[1];
  if (part.most_s != 0 && part.most_s < part.least_s)
    t.refuse("seconds", "expects [least, most] with most >= least, or 0 for no end");
  constexpr std::array<std::pair<const char*, bool>, 2> kScreens{{{"dark", false}, {"head", true}}};
  part.head_visible = one_of(t, "screen", t.text("screen", "dark"), kScreens);
}

void read_experiment(TomlTable& t, Part& part) {
  TomlTable rating = t.table("rating", "rating of " + part.id);
  part.rating.id = "rating";
  read_rating(rating, part.rating);
  rating.finish();
  part.where.id = "where";
  part.where.type = QuestionType::text;
  part.where.text = t.text("describe", "");
  const int most = static_cast<int>(part.regions.size());
  part.toughest = t.integer("toughest", 0, 0, most);
  part.softest = t.integer("softest", 0, 0, most);
  if (part.toughest + part.softest > most)
    t.refuse("softest", fmt::format("toughest and softest together are more than {}", most));
}

void read_tutorial(TomlTable& t, Part& part) {
  // All three are asked for before any is missed, so that a misspelt one is named.
  const std::string gate = t.text("gate", ""), again = t.text("gate-again", "");
  part.excused = t.text("excused", "");
  if (gate.empty()) return;
  part.gate = yes_or_no("gate", gate);
  part.gate_again = yes_or_no("gate-again", again);
}

void read_staircase(TomlTable t, Staircase& s) {
  s.start = t.number("start", s.start, 1e-3, 10);
  s.least = t.number("least", s.least, 1e-3, s.start);
  s.most = t.number("most", s.most, s.start, 20);
  s.step = t.number("step", s.step, 1.01, 10);
  s.fine_step = t.number("fine-step", s.fine_step, 1.01, s.step);
  s.correct_for_down = t.integer("correct-for-down", s.correct_for_down, 1, 5);
  s.reversals = t.integer("reversals", s.reversals, 4, 100);
  s.most_trials = t.integer("most-trials", s.most_trials, 10, 1000);
  t.finish();
}

/// What several keys say together; after each one was read, so that a misspelt one comes first.
void check_part(const TomlTable& t, const Part& part) {
  if (!part.where.text.empty() && !part.head_visible)
    t.refuse("describe", "a place can be described only where screen = \"head\"");
  if (part.gate.text.empty()) return;
  if (part.gate_again.text.empty()) t.refuse("gate-again", "is missing; a gate asks twice");
  if (part.excused.empty()) t.refuse("excused", "is missing; say why the study ends here");
}

Part read_part(TomlTable t, const Protocol& protocol) {
  Part part;
  part.id = checked_id(t, "id", t.text("id"));
  t.name("part " + part.id);
  for (const Part& other : protocol.parts)
    if (other.id == part.id) t.refuse("id", fmt::format("{} appears twice", part.id));
  constexpr std::array<std::pair<const char*, PartKind>, 5> kKinds{
      {{"consent", PartKind::consent},
       {"questions", PartKind::questions},
       {"tutorial", PartKind::tutorial},
       {"experiment", PartKind::experiment},
       {"discrimination", PartKind::discrimination}}};
  part.kind = one_of(t, "kind", t.text("kind"), kKinds);
  part.title = t.text("title");
  part.text = part.kind == PartKind::consent ? t.text("text") : t.text("text", "");
  if (part.kind == PartKind::questions)
    for (TomlTable& q : t.tables("question", "question")) {
      Question question = read_question(q);
      for (const Question& other : part.questions)
        if (other.id == question.id) q.refuse("id", fmt::format("{} appears twice", question.id));
      part.questions.push_back(std::move(question));
    }
  if (rounds_of(part) > 0 || part.kind == PartKind::tutorial) read_touch(t, part, protocol);
  if (part.kind == PartKind::tutorial) read_tutorial(t, part);
  if (part.kind == PartKind::experiment) read_experiment(t, part);
  if (part.kind == PartKind::discrimination && t.has("staircase"))
    read_staircase(t.table("staircase", "staircase of " + part.id), part.staircase);
  t.finish();
  check_part(t, part);
  return part;
}

bool asks(const Protocol& protocol, const std::string& key) {
  for (const Part& part : protocol.parts)
    for (const Question& q : part.questions)
      if (part.id + "/" + q.id == key) return true;
  return false;
}

void read_analysis(TomlTable t, Protocol& protocol) {
  Analysis& a = protocol.analysis;
  for (auto& [key, value] : {std::pair{"group", &a.group}, {"rationality", &a.rationality}}) {
    *value = t.text(key, "");
    if (!value->empty() && !asks(protocol, *value))
      t.refuse(key, fmt::format("no part asks {}; write part/question", *value));
  }
  for (auto& [key, value] :
       {std::pair{"touch-only", &a.touch_only}, {"touch-and-sight", &a.touch_and_sight}}) {
    *value = t.text(key, "");
    const bool known = std::any_of(protocol.parts.begin(), protocol.parts.end(), [&](auto& part) {
      return part.id == *value && part.kind == PartKind::experiment;
    });
    if (!value->empty() && !known)
      t.refuse(key, fmt::format("{} is no part of kind \"experiment\"", *value));
  }
  if (t.has("reference-order"))
    a.reference_order = read_regions(t, "reference-order", protocol.regions);
  a.rationality_reference = t.number("rationality-reference", 8, -kAny, kAny);
  t.finish();
}

}  // namespace

Protocol parse_protocol(std::string_view text, const std::string& file) {
  const toml::table table = parse_toml(text, file);
  TomlTable t(table, file, "protocol");
  Protocol p;
  p.text = text;
  const int format = t.integer("format", 0, 0, std::numeric_limits<int>::max());
  if (format != kFormat)
    t.refuse("format", fmt::format("expects {}, the form that this Palpate reads", kFormat));
  p.name = checked_id(t, "name", t.text("name"));
  p.title = t.text("title");
  p.source = t.text("source", "");
  p.participants = t.integer("participants", 1, 1, kMostParticipants);
  std::vector<std::string> known(kSkinRegionNames.begin() + 1, kSkinRegionNames.end());
  p.regions = read_regions(t, "regions", known);
  for (TomlTable& part : t.tables("part", "part")) p.parts.push_back(read_part(part, p));
  if (t.has("analysis")) read_analysis(t.table("analysis", "analysis"), p);
  t.finish();
  return p;
}

Protocol read_protocol(const std::filesystem::path& path) {
  return parse_protocol(read_file(path), path.string());
}

}  // namespace palpate::study
