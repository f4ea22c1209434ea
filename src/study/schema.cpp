// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/schema.hpp"

#include <fmt/format.h>

#include <array>

#include "study/samples.hpp"
#include "study/store.hpp"
#include "study/store_inner.hpp"

namespace palpate::study {
namespace {

// Everything that came from a person hangs on participant by ON DELETE CASCADE or is deleted by
// Store::withdraw().
constexpr const char* kFirst = R"sql(
CREATE TABLE study(
  one INTEGER PRIMARY KEY CHECK (one = 1),
  id TEXT NOT NULL, title TEXT NOT NULL, protocol_name TEXT NOT NULL,
  protocol_text TEXT NOT NULL, protocol_crc INTEGER NOT NULL,
  head_name TEXT NOT NULL, head_fingerprint TEXT NOT NULL, tool_radius_mm REAL NOT NULL,
  seed TEXT NOT NULL, program TEXT NOT NULL, created_ms INTEGER NOT NULL,
  planned_participants INTEGER NOT NULL, simulation TEXT NOT NULL DEFAULT '');
CREATE TABLE region(
  place INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,
  stiffness_n_mm REAL, stiffness_at_point_n_mm REAL,
  x_mm REAL, y_mm REAL, z_mm REAL, normal_x REAL, normal_y REAL, normal_z REAL);
CREATE TABLE participant(
  id INTEGER PRIMARY KEY, pseudonym TEXT NOT NULL UNIQUE, order_index INTEGER NOT NULL UNIQUE,
  simulated INTEGER NOT NULL CHECK (simulated IN (0, 1)),
  state TEXT NOT NULL CHECK (state IN ('enrolled','running','finished','excused','withdrawn')),
  enrolled_ms INTEGER NOT NULL, ended_ms INTEGER NOT NULL DEFAULT 0,
  withdrawn_ms INTEGER NOT NULL DEFAULT 0);
CREATE TABLE plan(
  participant INTEGER NOT NULL REFERENCES participant(id) ON DELETE CASCADE,
  part TEXT NOT NULL, round INTEGER NOT NULL, place INTEGER NOT NULL,
  region TEXT NOT NULL REFERENCES region(name),
  PRIMARY KEY (participant, part, round, place)) WITHOUT ROWID;
CREATE TABLE session(
  id INTEGER PRIMARY KEY, participant INTEGER NOT NULL REFERENCES participant(id) ON DELETE CASCADE,
  started_ms INTEGER NOT NULL, ended_ms INTEGER NOT NULL DEFAULT 0);
CREATE TABLE trial(
  id INTEGER PRIMARY KEY, participant INTEGER NOT NULL REFERENCES participant(id) ON DELETE CASCADE,
  session INTEGER NOT NULL REFERENCES session(id) ON DELETE CASCADE,
  part TEXT NOT NULL, key TEXT NOT NULL, place INTEGER NOT NULL, attempt INTEGER NOT NULL,
  region TEXT NOT NULL REFERENCES region(name), head_visible INTEGER NOT NULL,
  factor REAL NOT NULL, interval INTEGER NOT NULL,
  started_ms INTEGER NOT NULL, ended_ms INTEGER NOT NULL DEFAULT 0,
  UNIQUE (participant, key, attempt));
CREATE TABLE answer(
  id INTEGER PRIMARY KEY, participant INTEGER NOT NULL REFERENCES participant(id) ON DELETE CASCADE,
  session INTEGER NOT NULL REFERENCES session(id) ON DELETE CASCADE,
  trial INTEGER REFERENCES trial(id) ON DELETE CASCADE,
  key TEXT NOT NULL, value TEXT NOT NULL, asked_ms INTEGER NOT NULL, answered_ms INTEGER NOT NULL,
  crc INTEGER NOT NULL, UNIQUE (participant, key));
CREATE TABLE samples(
  id INTEGER PRIMARY KEY, trial INTEGER NOT NULL REFERENCES trial(id) ON DELETE CASCADE,
  sequence INTEGER NOT NULL, count INTEGER NOT NULL, data BLOB NOT NULL, crc INTEGER NOT NULL,
  UNIQUE (trial, sequence));
CREATE TABLE event(
  id INTEGER PRIMARY KEY, participant INTEGER REFERENCES participant(id) ON DELETE CASCADE,
  time_ms INTEGER NOT NULL, kind TEXT NOT NULL, detail TEXT NOT NULL);
CREATE INDEX answer_of_trial ON answer(trial);
CREATE INDEX trial_of_session ON trial(session);
CREATE INDEX answer_of_session ON answer(session);
CREATE INDEX event_of_participant ON event(participant);
)sql";

// What an analysis wants of a block without decoding it.
constexpr const char* kSummaries = R"sql(
ALTER TABLE samples ADD COLUMN peak_force_n REAL NOT NULL DEFAULT 0;
ALTER TABLE samples ADD COLUMN contact_s REAL NOT NULL DEFAULT 0;
)sql";

void fill_summaries(Database& db) {
  Statement all(db, "SELECT id, data FROM samples");
  while (all.row()) {
    BlockSummary summary;
    try {
      summary = summarised(decode_samples(all.blob(1)));
    } catch (const InputError&) {
      // `palpate study check` tells of the damaged block; its summary stays zero.
    }
    Statement set(db, "UPDATE samples SET peak_force_n = ?, contact_s = ? WHERE id = ?");
    set.bind(summary.peak_force).bind(summary.contact_s).bind(all.integer(0)).done();
  }
}

constexpr std::array kSteps = {SchemaStep{kFirst, nullptr}, SchemaStep{kSummaries, fill_summaries}};
static_assert(kSteps.size() == kStoreVersion);

}  // namespace

std::span<const SchemaStep> schema_steps() {
  return kSteps;
}

void bring_up_to_date(Database& db) {
  Transaction all(db);
  const std::int64_t version = db.number("PRAGMA user_version");
  for (std::int64_t v = version; v < kStoreVersion; ++v) {
    const SchemaStep& step = kSteps[static_cast<std::size_t>(v)];
    db.run(step.sql);
    if (step.fill) step.fill(db);
  }
  db.run(fmt::format("PRAGMA user_version = {}", kStoreVersion).c_str());
  db.run(fmt::format("PRAGMA application_id = {}", kApplicationId).c_str());
  all.commit();
}

}  // namespace palpate::study
