// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <set>

#include "study/run.hpp"
#include "study/samples.hpp"
#include "study/store_inner.hpp"

namespace palpate::study {
namespace {

using Findings = std::vector<std::string>;

void check_sqlite(Database& db, Findings& out) {
  Statement whole(db, "PRAGMA integrity_check(20)");
  while (whole.row())
    if (whole.text(0) != "ok") out.push_back("SQLite: " + whole.text(0));
  Statement keys(db, "PRAGMA foreign_key_check");
  while (keys.row())
    out.push_back(fmt::format("row {} of table {} refers to a row of {} that is not there",
                              keys.integer(1), keys.text(0), keys.text(2)));
}

void check_answers(Database& db, Findings& out) {
  Statement rows(db,
                 "SELECT p.pseudonym, a.key, a.value, a.asked_ms, a.answered_ms, a.crc FROM "
                 "answer a JOIN participant p ON p.id = a.participant");
  while (rows.row()) {
    Answer a;
    a.pseudonym = rows.text(0);
    a.key = rows.text(1);
    a.value = rows.text(2);
    a.asked = rows.integer(3);
    a.answered = rows.integer(4);
    if (answer_checksum(a.pseudonym, a) != rows.integer(5))
      out.push_back(
          fmt::format("{}: the answer to {} was changed after it was given", a.pseudonym, a.key));
    if (a.answered < a.asked)
      out.push_back(fmt::format("{}: {} was answered before it was asked", a.pseudonym, a.key));
  }
}

void check_samples(Database& db, Findings& out) {
  Statement rows(db,
                 "SELECT trial, sequence, count, crc, data FROM samples ORDER BY trial, sequence");
  std::int64_t trial = 0, expected = 0, last_us = -1;
  while (rows.row()) {
    if (rows.integer(0) != trial) expected = 0, last_us = -1;
    trial = rows.integer(0);
    const std::int64_t sequence = rows.integer(1);
    if (sequence != expected)
      out.push_back(fmt::format("trial {}: block {} of its samples is missing", trial, expected));
    expected = sequence + 1;
    const std::string_view data = rows.blob(4);
    std::vector<HapticSample> samples;
    try {
      if (checksum(data) != rows.integer(3)) throw InputError("its check sum differs");
      samples = decode_samples(data);
      if (static_cast<std::int64_t>(samples.size()) != rows.integer(2))
        throw InputError("it has another number of samples than it says");
    } catch (const InputError& error) {
      out.push_back(
          fmt::format("trial {}: block {} is damaged: {}", trial, sequence, error.what()));
      continue;
    }
    for (const HapticSample& s : samples) {
      if (s.time_us <= last_us) {
        out.push_back(fmt::format("trial {}: block {} goes back in time", trial, sequence));
        break;
      }
      last_us = s.time_us;
    }
  }
}

// The answers must be those that the protocol asks for, in its order: each is the next one.
void check_order(const Store& store, const Participant& p, const Protocol& protocol,
                 std::uint64_t seed, Findings& out) {
  const Draw draw{store.plan(p.pseudonym), seed, p.order_index};
  if (p.state == ParticipantState::withdrawn) {
    if (!draw.orders.empty() || !store.answers(p.pseudonym).empty())
      out.push_back(fmt::format("{} has withdrawn, but has left data", p.pseudonym));
    return;
  }
  Answers given;
  Screen screen = next_screen(protocol, draw, given);
  for (const Answer& a : store.answers(p.pseudonym)) {
    if (a.key != screen.key) {
      out.push_back(fmt::format("{}: {} was answered where the protocol asks for {}", p.pseudonym,
                                a.key, screen.key));
      return;
    }
    try {
      (void)checked_value(screen, a.value);
    } catch (const InputError& error) {
      out.push_back(fmt::format("{}: {}: {}", p.pseudonym, a.key, error.what()));
    }
    given[a.key] = a.value;
    screen = next_screen(protocol, draw, given);
  }
  const bool over = screen.kind == ScreenKind::finished || screen.kind == ScreenKind::excused;
  if (p.state == ParticipantState::finished && !over)
    out.push_back(
        fmt::format("{} counts as finished, but {} is not answered", p.pseudonym, screen.key));
}

void check_plan(const Store& store, const Participant& p, const Protocol& protocol, Findings& out) {
  if (p.state == ParticipantState::withdrawn) return;
  std::map<std::pair<std::string, int>, std::multiset<std::string>> found, wanted;
  for (const PlannedOrder& o : store.plan(p.pseudonym))
    found[{o.part, o.round}].insert(o.regions.begin(), o.regions.end());
  for (const Part& part : protocol.parts)
    for (int round = 1; round <= rounds_of(part); ++round)
      wanted[{part.id, round}].insert(part.regions.begin(), part.regions.end());
  if (found != wanted)
    out.push_back(fmt::format("{}: an order is not a permutation of the regions", p.pseudonym));
}

}  // namespace

std::vector<std::string> check_store(const std::filesystem::path& path) {
  const Store store = Store::open(path, Store::Access::read);
  Database db(path, Database::Mode::read);
  Findings out;
  check_sqlite(db, out);
  check_answers(db, out);
  check_samples(db, out);
  const Study study = store.study();
  if (db.number("SELECT protocol_crc FROM study") != checksum(study.protocol_text)) {
    out.push_back("the protocol was changed after the study began");
    return out;
  }
  const Protocol protocol = parse_protocol(study.protocol_text, study.protocol_name + ".toml");
  for (const Participant& p : store.participants()) {
    check_plan(store, p, protocol, out);
    check_order(store, p, protocol, study.seed, out);
  }
  return out;
}

}  // namespace palpate::study
