// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <fstream>

#include "study/samples.hpp"
#include "study/schema.hpp"
#include "study/store_inner.hpp"

namespace palpate::study {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse_damaged(const fs::path& path, std::string why) {
  for (char& c : why)
    if (c == '\n') c = ' ';
  throw InputError(fmt::format(
      "{}: the study file is damaged ({}); go back to a copy, or keep what is readable with "
      "sqlite3's .recover",
      path.string(), why));
}

// SQLite overlooks a missing end that holds only free pages. While a log stands beside the file
// the length may lag behind.
void check_length(const fs::path& path, std::ifstream& in) {
  std::error_code error;
  const fs::path log = path.string() + "-wal";
  if (fs::exists(log, error) && fs::file_size(log, error) > 0) return;
  std::array<unsigned char, 100> header{};
  in.seekg(0);
  in.read(reinterpret_cast<char*>(header.data()), header.size());
  if (!in) refuse_damaged(path, "it is cut short");
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uintmax_t n = 0;
    for (std::size_t i = 0; i < bytes; ++i) n = n << 8U | header[at + i];
    return n;
  };
  const std::uintmax_t page = number(16, 2) == 1 ? 65536 : number(16, 2);
  if (fs::file_size(path, error) != page * number(28, 4))
    refuse_damaged(path, "its length is not the one that it tells");
}

}  // namespace

std::int64_t examine(const fs::path& path, bool thorough) {
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    throw InputError(fmt::format("{}: there is no such study file", path.string()));
  constexpr std::string_view kMagic{"SQLite format 3", 16};
  std::string magic(kMagic.size(), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(fmt::format("{}: cannot read the study: permission denied", path.string()));
  in.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != kMagic)
    throw InputError(
        fmt::format("{}: not a study file, or its beginning is damaged", path.string()));
  check_length(path, in);
  Database db(path, Database::Mode::read);
  const std::int64_t version = db.number("PRAGMA user_version");
  if (db.number("PRAGMA application_id") != kApplicationId || version < 1)
    throw InputError(fmt::format("{}: a database, but not a Palpate study", path.string()));
  if (version > kStoreVersion)
    throw InputError(
        fmt::format("{}: study format {} of a later Palpate; this one reads up to {}: update it",
                    path.string(), version, kStoreVersion));
  // A gigabyte takes seconds; readers of large files meet damage where they read it.
  constexpr std::uintmax_t kLarge = 256U << 20U;
  if (!thorough && fs::file_size(path, error) > kLarge) return version;
  Statement check(db, "PRAGMA quick_check(1)");
  const std::string said = check.row() ? check.text(0) : "no answer";
  if (said != "ok") refuse_damaged(path, said);
  return version;
}

std::string part_of(const std::string& key) {
  return key.substr(0, key.find('/'));
}
std::string question_of(const std::string& key) {
  const std::size_t slash = key.rfind('/');
  return slash == std::string::npos ? key : key.substr(slash + 1);
}

namespace {

ParticipantState state_named(const std::string& text) {
  const auto at = std::find(kParticipantStateNames.begin(), kParticipantStateNames.end(), text);
  return static_cast<ParticipantState>(at - kParticipantStateNames.begin());
}

constexpr const char* kAnswers =
    "SELECT a.id, p.pseudonym, a.key, a.value, a.asked_ms, a.answered_ms FROM answer a "
    "JOIN participant p ON p.id = a.participant ";

std::vector<Answer> read_answers(Statement& rows) {
  std::vector<Answer> all;
  while (rows.row()) {
    Answer a;
    a.id = rows.integer(0);
    a.pseudonym = rows.text(1);
    a.key = rows.text(2);
    a.part = part_of(a.key);
    a.question = question_of(a.key);
    a.value = rows.text(3);
    a.asked = rows.integer(4);
    a.answered = rows.integer(5);
    all.push_back(std::move(a));
  }
  return all;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from < list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    parts.push_back(list.substr(from, comma - from));
    from = comma + 1;
  }
  return parts;
}

/// The places that were chosen, as the regions that lay there.
std::vector<std::string> chosen_regions(Database& db, const Answer& a) {
  std::vector<std::string> regions;
  for (const std::string& place : split(a.value)) {
    Statement find(db,
                   "SELECT region FROM plan JOIN participant p ON p.id = participant "
                   "WHERE p.pseudonym = ? AND part = ? AND round = 1 AND place = ?");
    find.bind(a.pseudonym).bind(a.part).bind(static_cast<std::int64_t>(std::stoi(place)));
    if (find.row()) regions.push_back(find.text(0));
  }
  return regions;
}

}  // namespace

Study Store::study() const {
  Statement row(*inner_->db,
                "SELECT id, title, protocol_name, protocol_text, head_name, head_fingerprint, "
                "tool_radius_mm, seed, program, created_ms, planned_participants, simulation, "
                "(SELECT count(*) FROM participant WHERE simulated) FROM study");
  if (!row.row())
    throw InputError(fmt::format("{}: the study's own row is missing", inner_->path.string()));
  Study s;
  s.id = row.text(0);
  s.title = row.text(1);
  s.protocol_name = row.text(2);
  s.protocol_text = row.text(3);
  s.head_name = row.text(4);
  s.head_fingerprint = row.text(5);
  s.tool_radius = row.real(6);
  s.seed = std::stoull(row.text(7));
  s.program = row.text(8);
  s.created = row.integer(9);
  s.planned_participants = static_cast<int>(row.integer(10));
  s.simulation = row.text(11);
  s.simulated = row.integer(12) > 0 || !s.simulation.empty();
  Statement regions(*inner_->db,
                    "SELECT name, stiffness_n_mm, stiffness_at_point_n_mm, x_mm, y_mm, z_mm, "
                    "normal_x, normal_y, normal_z FROM region ORDER BY place");
  while (regions.row()) {
    StudyRegion r;
    r.name = regions.text(0);
    r.stiffness = regions.real(1);
    r.stiffness_at_point = regions.real(2);
    r.point = {regions.real(3), regions.real(4), regions.real(5)};
    r.normal = {regions.real(6), regions.real(7), regions.real(8)};
    s.regions.push_back(std::move(r));
  }
  return s;
}

std::vector<Participant> Store::participants() const {
  std::vector<Participant> all;
  Statement rows(*inner_->db,
                 "SELECT id, pseudonym, order_index, simulated, state, enrolled_ms, ended_ms, "
                 "withdrawn_ms FROM participant ORDER BY order_index");
  while (rows.row()) {
    Participant p;
    p.id = rows.integer(0);
    p.pseudonym = rows.text(1);
    p.order_index = static_cast<int>(rows.integer(2));
    p.simulated = rows.integer(3) != 0;
    p.state = state_named(rows.text(4));
    p.enrolled = rows.integer(5);
    p.ended = rows.integer(6);
    p.withdrawn = rows.integer(7);
    all.push_back(std::move(p));
  }
  if (!inner_->protocol) inner_->protocol = parse_protocol(study().protocol_text, "protocol");
  // Background: what was asked before anything was touched.
  std::vector<std::string> before;
  for (const Part& part : inner_->protocol->parts) {
    if (part.kind != PartKind::consent && part.kind != PartKind::questions) break;
    for (const Question& q : part.questions) before.push_back(part.id + "/" + q.id);
  }
  for (const Answer& a : answers()) {
    const auto who = std::find_if(all.begin(), all.end(),
                                  [&](const Participant& p) { return p.pseudonym == a.pseudonym; });
    if (who == all.end()) continue;
    if (std::find(before.begin(), before.end(), a.key) != before.end())
      who->background[a.question] = a.value;
    if (a.key == inner_->protocol->analysis.group) who->group = a.value;
  }
  return all;
}

std::vector<Session> Store::sessions() const {
  std::vector<Session> all;
  Statement rows(*inner_->db,
                 "SELECT s.id, p.pseudonym, s.started_ms, s.ended_ms FROM session s JOIN "
                 "participant p ON p.id = s.participant ORDER BY p.order_index, s.id");
  while (rows.row())
    all.push_back({rows.integer(0), rows.text(1), rows.integer(2), rows.integer(3)});
  return all;
}

std::vector<TrialRecord> Store::trials() const {
  std::vector<TrialRecord> all;
  Statement rows(
      *inner_->db,
      "SELECT t.id, p.pseudonym, t.part, t.key, t.place, t.attempt, t.region, t.head_visible, "
      "t.factor, t.interval, t.started_ms, t.ended_ms, r.value, w.value, "
      "t.attempt = (SELECT max(attempt) FROM trial u WHERE u.participant = t.participant AND "
      "u.key = t.key) FROM trial t JOIN participant p ON p.id = t.participant "
      "LEFT JOIN answer r ON r.participant = t.participant AND r.key = t.key || '/rating' "
      "LEFT JOIN answer w ON w.participant = t.participant AND w.key = t.key || '/where' "
      "ORDER BY p.order_index, t.id");
  while (rows.row()) {
    TrialRecord t;
    t.id = rows.integer(0);
    t.pseudonym = rows.text(1);
    t.experiment = rows.text(2);
    t.key = rows.text(3);
    t.index = static_cast<int>(rows.integer(4));
    t.attempt = static_cast<int>(rows.integer(5));
    t.region = rows.text(6);
    t.head_visible = rows.integer(7) != 0;
    t.factor = rows.real(8);
    t.interval = static_cast<int>(rows.integer(9));
    t.started = rows.integer(10);
    t.ended = rows.integer(11);
    t.last_attempt = rows.integer(14) != 0;
    if (t.last_attempt) {
      t.rating = rows.real(12);
      t.description = rows.text(13);
    }
    all.push_back(std::move(t));
  }
  return all;
}

std::vector<Choice> Store::choices() const {
  std::vector<Choice> all;
  for (const Answer& a : answers()) {
    const bool toughest = a.question == "toughest", softest = a.question == "softest";
    if (!toughest && !softest) continue;
    auto at = std::find_if(all.begin(), all.end(), [&](const Choice& c) {
      return c.pseudonym == a.pseudonym && c.experiment == a.part;
    });
    if (at == all.end()) at = all.insert(all.end(), {a.pseudonym, a.part, {}, {}});
    (toughest ? at->toughest : at->softest) = chosen_regions(*inner_->db, a);
  }
  return all;
}

std::vector<Comparison> Store::comparisons() const {
  std::vector<Comparison> all;
  Statement rows(*inner_->db,
                 "SELECT p.pseudonym, a.key, a.value, one.region, one.place, one.factor, "
                 "two.factor FROM answer a JOIN participant p ON p.id = a.participant "
                 "JOIN trial one ON one.participant = a.participant AND one.interval = 1 AND "
                 "one.key || '/stiffer' = replace(a.key, '/stiffer', '/1/stiffer') "
                 "JOIN trial two ON two.participant = a.participant AND two.interval = 2 AND "
                 "two.key || '/stiffer' = replace(a.key, '/stiffer', '/2/stiffer') "
                 "WHERE a.key LIKE '%/stiffer' GROUP BY a.id ORDER BY p.order_index, a.id");
  while (rows.row()) {
    Comparison c;
    c.pseudonym = rows.text(0);
    c.experiment = part_of(rows.text(1));
    c.answered = static_cast<int>(rows.integer(2));
    c.region = rows.text(3);
    c.index = static_cast<int>(rows.integer(4));
    const double one = rows.real(5), two = rows.real(6);
    c.stiffer = one > two ? 1 : 2;
    c.difference = std::max(one, two) / std::min(one, two) - 1;
    all.push_back(std::move(c));
  }
  return all;
}

std::vector<Answer> Store::answers() const {
  const std::string sql = std::string(kAnswers) + "ORDER BY p.order_index, a.id";
  Statement rows(*inner_->db, sql.c_str());
  return read_answers(rows);
}

std::vector<Answer> Store::answers(const std::string& pseudonym) const {
  const std::string sql = std::string(kAnswers) + "WHERE p.pseudonym = ? ORDER BY a.id";
  Statement rows(*inner_->db, sql.c_str());
  rows.bind(pseudonym);
  return read_answers(rows);
}

std::vector<PlannedOrder> Store::plan(const std::string& pseudonym) const {
  std::vector<PlannedOrder> all;
  Statement rows(*inner_->db,
                 "SELECT part, round, region FROM plan WHERE participant = ? "
                 "ORDER BY part, round, place");
  rows.bind(inner_->participant_id(pseudonym));
  while (rows.row()) {
    const std::string part = rows.text(0);
    const int round = static_cast<int>(rows.integer(1));
    if (all.empty() || all.back().part != part || all.back().round != round)
      all.push_back({part, round, {}});
    all.back().regions.push_back(rows.text(2));
  }
  return all;
}

std::vector<Event> Store::events() const {
  std::vector<Event> all;
  Statement rows(*inner_->db,
                 "SELECT e.time_ms, coalesce(p.pseudonym, ''), e.kind, e.detail FROM event e "
                 "LEFT JOIN participant p ON p.id = e.participant ORDER BY e.id");
  while (rows.row()) all.push_back({rows.integer(0), rows.text(1), rows.text(2), rows.text(3)});
  return all;
}

std::vector<SampleBlock> Store::block_summaries(std::int64_t trial) const {
  std::vector<SampleBlock> all;
  Statement rows(*inner_->db,
                 "SELECT trial, sequence, count, peak_force_n, contact_s, length(data) "
                 "FROM samples WHERE ?1 = 0 OR trial = ?1 ORDER BY trial, sequence");
  rows.bind(trial);
  while (rows.row()) {
    SampleBlock b;
    b.trial = rows.integer(0);
    b.sequence = static_cast<int>(rows.integer(1));
    b.count = static_cast<std::size_t>(rows.integer(2));
    b.peak_force = rows.real(3);
    b.contact_s = rows.real(4);
    b.bytes = static_cast<std::size_t>(rows.integer(5));
    all.push_back(b);
  }
  return all;
}

void Store::for_each_block(std::int64_t trial,
                           const std::function<void(const SampleBlock&)>& visit) const {
  Statement rows(*inner_->db,
                 "SELECT trial, sequence, peak_force_n, contact_s, crc, data FROM samples "
                 "WHERE ?1 = 0 OR trial = ?1 ORDER BY trial, sequence");
  rows.bind(trial);
  SampleBlock b;
  while (rows.row()) {
    b.trial = rows.integer(0);
    b.sequence = static_cast<int>(rows.integer(1));
    b.peak_force = rows.real(2);
    b.contact_s = rows.real(3);
    const std::string_view data = rows.blob(5);
    b.bytes = data.size();
    try {
      if (checksum(data) != rows.integer(4)) throw InputError("its check sum differs");
      b.samples = decode_samples(data);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: block {} of the samples of trial {} is damaged ({})",
                                   inner_->path.string(), b.sequence, b.trial, error.what()));
    }
    b.count = b.samples.size();
    visit(b);
  }
}

}  // namespace palpate::study
