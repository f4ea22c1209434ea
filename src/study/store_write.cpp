// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cmath>

#include "study/samples.hpp"
#include "study/schema.hpp"
#include "study/store_inner.hpp"

namespace palpate::study {
namespace fs = std::filesystem;

Moment now() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

RunLock::RunLock(const fs::path& path) : file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0)
    throw InputError(
        fmt::format("{}: cannot open the study: {}", path.string(), std::strerror(errno)));
  if (flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  close(file_);
  throw InputError(
      fmt::format("{}: another palpate is running this study; stop that one first", path.string()));
}
RunLock::~RunLock() {
  close(file_);
}

namespace {

void set_up(Database& db, Store::Durability durability) {
  db.run("PRAGMA foreign_keys = ON");
  db.run("PRAGMA secure_delete = ON");
  Statement(db, "PRAGMA journal_mode = WAL").done();
  db.run(durability == Store::Durability::full ? "PRAGMA synchronous = FULL"
                                               : "PRAGMA synchronous = NORMAL");
}

void write_study(Database& db, const Study& s) {
  Transaction all(db);
  Statement study(db,
                  "INSERT INTO study(one, id, title, protocol_name, protocol_text, protocol_crc, "
                  "head_name, head_fingerprint, tool_radius_mm, seed, program, created_ms, "
                  "planned_participants, simulation) VALUES (1,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  study.bind(s.id)
      .bind(s.title)
      .bind(s.protocol_name)
      .bind(s.protocol_text)
      .bind(std::int64_t{checksum(s.protocol_text)})
      .bind(s.head_name)
      .bind(s.head_fingerprint)
      .bind(s.tool_radius)
      .bind(fmt::format("{}", s.seed))
      .bind(s.program)
      .bind(s.created)
      .bind(std::int64_t{s.planned_participants})
      .bind(s.simulation)
      .done();
  std::int64_t place = 0;
  for (const StudyRegion& r : s.regions) {
    Statement region(db, "INSERT INTO region VALUES (?,?,?,?,?,?,?,?,?,?)");
    region.bind(place++).bind(r.name).bind(r.stiffness).bind(r.stiffness_at_point);
    for (const Vec3& v : {r.point, r.normal})
      for (int k = 0; k < 3; ++k) region.bind(v[k]);
    region.done();
  }
  all.commit();
}

}  // namespace

// The file appears under its name whole: a kill while it is made leaves at most "NAME.new".
Store Store::create(const fs::path& path, const Study& study, Durability durability) {
  if (fs::exists(path))
    throw InputError(fmt::format("{}: the file exists already; give another name", path.string()));
  const fs::path fresh = path.string() + ".new";
  std::error_code ignored;
  fs::remove(fresh, ignored);
  try {
    Database db(fresh, Database::Mode::create);
    bring_up_to_date(db);
    write_study(db, study);
  } catch (...) {  // a full disk, say: nothing half-made stays
    fs::remove(fresh, ignored);
    throw;
  }
  // A link, not a rename: it never replaces a file that came to be meanwhile.
  if (link(fresh.c_str(), path.c_str()) != 0) {
    const std::string why = std::strerror(errno);
    fs::remove(fresh, ignored);
    throw FileError(fmt::format("{}: cannot create the study: {}", path.string(), why));
  }
  fs::remove(fresh, ignored);
  return open(path, Access::run, durability);
}

Store Store::open(const fs::path& path, Access access, Durability durability) {
  auto inner = std::make_unique<Inner>();
  inner->path = path;
  inner->access = access;
  const std::int64_t version = examine(path, access == Access::run);
  if (access == Access::read) {
    if (version < kStoreVersion)
      throw InputError(
          fmt::format("{}: study format {} of an older Palpate; `palpate study upgrade {}` brings "
                      "it to {}",
                      path.string(), version, path.string(), kStoreVersion));
    inner->db = std::make_unique<Database>(path, Database::Mode::read);
    return Store(std::move(inner));
  }
  inner->lock = std::make_unique<RunLock>(path);
  std::error_code ignored;
  fs::remove(path.string() + ".new", ignored);  // a kill while the file was made leaves it
  inner->db = std::make_unique<Database>(path, Database::Mode::write);
  set_up(*inner->db, durability);
  bring_up_to_date(*inner->db);
  return Store(std::move(inner));
}

Store::Store(std::unique_ptr<Inner> inner) : inner_(std::move(inner)) {}
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;
Store::~Store() = default;

// A study at rest is one file without a log beside it, so that a copy of it is whole. A reader that
// looks on at this moment keeps the log; the next runner empties it.
Store::Inner::~Inner() {
  if (db && access == Access::run) {
    sqlite3_exec(db->handle(), "PRAGMA wal_checkpoint(TRUNCATE)", nullptr, nullptr, nullptr);
    sqlite3_exec(db->handle(), "PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
  }
  db.reset();
}

std::int64_t Store::Inner::participant_id(const std::string& pseudonym) {
  Statement find(*db, "SELECT id FROM participant WHERE pseudonym = ?");
  find.bind(pseudonym);
  if (!find.row())
    throw InputError(fmt::format("{}: there is no participant {}", path.string(), pseudonym));
  return find.integer(0);
}

int Store::next_order_index() const {
  return static_cast<int>(
      inner_->db->number("SELECT coalesce(max(order_index) + 1, 0) FROM participant"));
}

Participant Store::enrol(bool simulated, const std::vector<PlannedOrder>& orders) {
  Database& db = *inner_->db;
  Transaction all(db);
  Participant p;
  p.order_index = next_order_index();
  p.pseudonym = fmt::format("P{:03}", p.order_index + 1);
  p.simulated = simulated;
  p.enrolled = now();
  Statement add(db,
                "INSERT INTO participant(pseudonym, order_index, simulated, state, enrolled_ms) "
                "VALUES (?,?,?,'enrolled',?)");
  add.bind(p.pseudonym)
      .bind(std::int64_t{p.order_index})
      .bind(std::int64_t{simulated})
      .bind(p.enrolled)
      .done();
  p.id = db.last_id();
  for (const PlannedOrder& order : orders) {
    std::int64_t place = 1;
    for (const std::string& region : order.regions) {
      Statement plan(db, "INSERT INTO plan VALUES (?,?,?,?,?)");
      plan.bind(p.id).bind(order.part).bind(std::int64_t{order.round}).bind(place++);
      plan.bind(region).done();
    }
  }
  all.commit();
  return p;
}

std::int64_t Store::begin_session(const std::string& pseudonym) {
  const std::int64_t id = inner_->participant_id(pseudonym);
  Statement add(*inner_->db, "INSERT INTO session(participant, started_ms) VALUES (?,?)");
  add.bind(id).bind(now()).done();
  return inner_->db->last_id();
}

void Store::end_session(std::int64_t session) {
  Statement(*inner_->db, "UPDATE session SET ended_ms = ? WHERE id = ?")
      .bind(now())
      .bind(session)
      .done();
}

std::int64_t Store::begin_trial(std::int64_t session, const TrialRecord& t) {
  const std::int64_t id = inner_->participant_id(t.pseudonym);
  Statement add(*inner_->db,
                "INSERT INTO trial(participant, session, part, key, place, attempt, region, "
                "head_visible, factor, interval, started_ms) SELECT ?1,?2,?3,?4,?5, "
                "1 + (SELECT count(*) FROM trial WHERE participant = ?1 AND key = ?4), "
                "?6,?7,?8,?9,?10");
  add.bind(id).bind(session).bind(t.experiment).bind(t.key).bind(std::int64_t{t.index});
  add.bind(t.region).bind(std::int64_t{t.head_visible}).bind(t.factor);
  add.bind(std::int64_t{t.interval}).bind(now()).done();
  return inner_->db->last_id();
}

void Store::end_trial(std::int64_t trial) {
  Statement(*inner_->db, "UPDATE trial SET ended_ms = ? WHERE id = ?")
      .bind(now())
      .bind(trial)
      .done();
}

std::uint32_t answer_checksum(const std::string& pseudonym, const Answer& a) {
  return checksum(
      fmt::format("{}\n{}\n{}\n{}\n{}", pseudonym, a.key, a.asked, a.answered, a.value));
}

void Store::add_answer(std::int64_t session, std::int64_t trial, const Answer& a) {
  const std::int64_t id = inner_->participant_id(a.pseudonym);
  Statement known(*inner_->db, "SELECT 1 FROM answer WHERE participant = ? AND key = ?");
  if (known.bind(id).bind(a.key).row())
    throw InputError(fmt::format("{} has answered {} already", a.pseudonym, a.key));
  Statement add(*inner_->db,
                "INSERT INTO answer(participant, session, trial, key, value, asked_ms, "
                "answered_ms, crc) VALUES (?,?,nullif(?,0),?,?,?,?,?)");
  add.bind(id).bind(session).bind(trial).bind(a.key).bind(a.value).bind(a.asked).bind(a.answered);
  add.bind(std::int64_t{answer_checksum(a.pseudonym, a)}).done();
}

BlockSummary summarised(std::span<const HapticSample> samples) {
  BlockSummary s;
  constexpr double kLongestStep = 0.1;  // [s] a longer one is a gap, not a contact
  for (std::size_t i = 0; i < samples.size(); ++i) {
    s.peak_force = std::max(s.peak_force, samples[i].force.norm());
    const std::size_t a = i + 1 < samples.size() ? i : i - 1;
    if (!samples[i].contact || samples.size() < 2) continue;
    const double step = 1e-6 * static_cast<double>(samples[a + 1].time_us - samples[a].time_us);
    s.contact_s += std::min(step, kLongestStep);
  }
  return s;
}

void Store::add_samples(std::int64_t trial, std::span<const HapticSample> samples) {
  if (samples.empty()) return;
  const std::string data = encode_samples(samples);
  const BlockSummary summary = summarised(samples);
  Statement add(*inner_->db,
                "INSERT INTO samples(trial, sequence, count, data, crc, peak_force_n, contact_s) "
                "SELECT ?1, (SELECT coalesce(max(sequence) + 1, 0) FROM samples WHERE trial = ?1), "
                "?2,?3,?4,?5,?6");
  add.bind(trial).bind(static_cast<std::int64_t>(samples.size())).bind_blob(data);
  add.bind(std::int64_t{checksum(data)}).bind(summary.peak_force).bind(summary.contact_s).done();
}

void Store::set_state(const std::string& pseudonym, ParticipantState state) {
  const bool over = state == ParticipantState::finished || state == ParticipantState::excused;
  Statement set(*inner_->db, "UPDATE participant SET state = ?, ended_ms = ? WHERE id = ?");
  set.bind(std::string(name(state))).bind(over ? now() : 0);
  set.bind(inner_->participant_id(pseudonym)).done();
}

void Store::set_simulation(const std::string& json) {
  Statement(*inner_->db, "UPDATE study SET simulation = ?").bind(json).done();
}

void Store::add_event(const std::string& pseudonym, const std::string& kind,
                      const std::string& detail) {
  Statement add(*inner_->db,
                "INSERT INTO event(participant, time_ms, kind, detail) VALUES (nullif(?,0),?,?,?)");
  add.bind(pseudonym.empty() ? 0 : inner_->participant_id(pseudonym));
  add.bind(now()).bind(kind).bind(detail).done();
}

// secure_delete overwrites the freed pages; the log still holds them as they were, until it is cut.
void Store::withdraw(const std::string& pseudonym) {
  Database& db = *inner_->db;
  const std::int64_t id = inner_->participant_id(pseudonym);
  {
    Transaction all(db);
    for (const char* sql :
         {"DELETE FROM session WHERE participant = ?", "DELETE FROM trial WHERE participant = ?",
          "DELETE FROM answer WHERE participant = ?", "DELETE FROM plan WHERE participant = ?",
          "DELETE FROM event WHERE participant = ?"})
      Statement(db, sql).bind(id).done();
    Statement(db,
              "UPDATE participant SET state = 'withdrawn', withdrawn_ms = ?, enrolled_ms = 0, "
              "ended_ms = 0 WHERE id = ?")
        .bind(now())
        .bind(id)
        .done();
    all.commit();
  }
  if (db.number("PRAGMA wal_checkpoint(TRUNCATE)") != 0)
    throw FileError(fmt::format(
        "{}: {} is deleted, but another program that reads the study keeps the log from being "
        "emptied; close it and withdraw {} again",
        inner_->path.string(), pseudonym, pseudonym));
}

const fs::path& Store::path() const {
  return inner_->path;
}

}  // namespace palpate::study
