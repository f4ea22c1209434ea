// SPDX-License-Identifier: GPL-3.0-or-later
// The study file: what goes in comes out, what is damaged is refused, what is deleted is gone.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <fstream>

#include "core/error.hpp"
#include "study/random.hpp"
#include "study/samples.hpp"
#include "study/scenes.hpp"
#include "study/schema.hpp"

namespace palpate::study {
namespace {
namespace fs = std::filesystem;

std::vector<HapticSample> press(std::size_t count, std::int64_t from_us = 0) {
  std::vector<HapticSample> all(count);
  Random noise(3, "press");
  for (std::size_t i = 0; i < count; ++i) {
    const double t = 1e-3 * static_cast<double>(i);
    HapticSample& s = all[i];
    s.time_us = from_us + static_cast<std::int64_t>(1000 * i + noise.below(9));
    s.position = {3 * std::sin(t), -2 * std::cos(2 * t), 12 - 9 * std::sin(3 * t)};
    s.contact = s.position.z() < 8;
    if (s.contact) s.force = {0.01 * noise.normal(), 0.2 * t, 1.5 * (8 - s.position.z())};
    s.region = 3;
  }
  return all;
}

TEST(Samples, KeepTheirQuantumAndStaySmall) {
  const auto before = press(1000);
  const std::string bytes = encode_samples(before);
  const auto after = decode_samples(bytes);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].time_us, before[i].time_us);
    EXPECT_LE((after[i].position - before[i].position).cwiseAbs().maxCoeff(), 0.51e-4);
    EXPECT_LE((after[i].force - before[i].force).cwiseAbs().maxCoeff(), 0.51e-4);
    EXPECT_EQ(after[i].contact, before[i].contact);
    EXPECT_EQ(after[i].region, before[i].region);
  }
  EXPECT_LT(bytes.size(), 16 * before.size());
  EXPECT_EQ(encode_samples(after), bytes) << "what was read is written the same";
  EXPECT_TRUE(decode_samples(encode_samples({})).empty());
}

TEST(Samples, CutOrChangedBytesAreRefusedOrReadWithoutHarm) {
  const std::string bytes = encode_samples(press(200));
  for (std::size_t n = 0; n < bytes.size(); n += 7)
    EXPECT_THROW((void)decode_samples(std::string_view(bytes).substr(0, n)), InputError) << n;
  Random chance(5, "flip");
  for (int i = 0; i < 2000; ++i) {
    std::string broken = bytes;
    broken[chance.below(broken.size())] ^= static_cast<char>(1U << chance.below(8));
    try {
      (void)decode_samples(broken);
    } catch (const InputError&) {
    }
  }
}

class StoreTest : public testing::Test {
 protected:
  scenes::Folder folder_;
  fs::path path_ = folder_ / "study.db";
  Protocol protocol_ = scenes::published();
  Study study_ = scenes::study_of(protocol_, 42);

  /// Answers up to and with `last`; gives the touched trials' number.
  void run(Store& store, const std::string& pseudonym, const std::string& last = "",
           const std::string& comment = "all fine") {
    const Draw draw{store.plan(pseudonym), study_.seed, 0};
    const std::int64_t session = store.begin_session(pseudonym);
    Answers answers;
    std::int64_t trial = 0;
    for (Screen s = next_screen(protocol_, draw, answers);
         s.kind != ScreenKind::finished && s.kind != ScreenKind::excused;
         s = next_screen(protocol_, draw, answers)) {
      if (s.kind == ScreenKind::touch) {
        TrialRecord t;
        t.pseudonym = pseudonym;
        t.experiment = s.part;
        t.key = s.key;
        t.index = s.place;
        t.region = s.region;
        t.head_visible = s.head_visible;
        trial = store.begin_trial(session, t);
        store.add_samples(trial, press(500));
        store.add_samples(trial, press(250, 500'000));
        store.end_trial(trial);
      }
      Answer a;
      a.pseudonym = pseudonym;
      a.key = s.key;
      a.value = checked_value(s, s.key == "closing/comments" ? comment : scenes::some_answer(s));
      a.asked = now();
      a.answered = now();
      store.add_answer(session, s.place > 0 ? trial : 0, a);
      answers[s.key] = a.value;
      if (s.key == last) return;
    }
    store.end_session(session);
    store.set_state(pseudonym, ParticipantState::finished);
  }
  std::string enrol(Store& store) {
    return store
        .enrol(false, draw_orders(protocol_, study_.regions, study_.seed, store.next_order_index()))
        .pseudonym;
  }
  void make(int participants = 1) {
    Store store = Store::create(path_, study_, Store::Durability::process);
    for (int i = 0; i < participants; ++i) run(store, enrol(store));
  }
  static std::string refusal(const fs::path& path, Store::Access access) {
    try {
      (void)Store::open(path, access);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  void expect_refused_untouched(const std::string& bytes, const std::string& said) {
    const fs::path other = folder_ / "broken.db";
    std::ofstream(other, std::ios::binary) << bytes;
    for (const auto access : {Store::Access::read, Store::Access::run}) {
      const std::string line = refusal(other, access);
      EXPECT_NE(line.find(said), std::string::npos) << line;
      EXPECT_NE(line.find("broken.db"), std::string::npos) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      EXPECT_TRUE(read_file(other) == bytes) << "the file was changed";
    }
    for (const char* side : {"broken.db-wal", "broken.db-shm", "broken.db-journal"})
      fs::remove(folder_ / side);
  }
};

TEST_F(StoreTest, GivesBackWhatWasPutIn) {
  make(2);
  const Store store = Store::open(path_, Store::Access::read);
  const Study s = store.study();
  EXPECT_EQ(s.protocol_text, study_.protocol_text);
  EXPECT_EQ(s.seed, 42U);
  EXPECT_EQ(s.regions.size(), 7U);
  EXPECT_FALSE(s.simulated);
  const auto people = store.participants();
  ASSERT_EQ(people.size(), 2U);
  EXPECT_EQ(people[1].pseudonym, "P002");
  EXPECT_EQ(people[1].group, "novice");
  EXPECT_EQ(people[1].background.at("age"), "22");
  EXPECT_FALSE(people[1].background.contains("comments"));
  EXPECT_EQ(people[0].state, ParticipantState::finished);
  const auto trials = store.trials();
  EXPECT_EQ(trials.size(), 2U * 28);
  int rated = 0;
  for (const TrialRecord& t : trials) {
    if (t.experiment == "tutorial")
      EXPECT_TRUE(std::isnan(t.rating));
    else
      EXPECT_EQ(t.rating, 3);
    rated += !std::isnan(t.rating);
    EXPECT_EQ(t.description, t.experiment == "sight" ? "beside the nose" : "");
  }
  EXPECT_EQ(rated, 2 * 14);
  const auto choices = store.choices();
  ASSERT_EQ(choices.size(), 4U);
  EXPECT_EQ(choices[0].toughest.size(), 2U);
  const auto plan = store.plan("P001");
  for (const PlannedOrder& o : plan)
    if (o.part == "touch") EXPECT_EQ(choices[0].toughest[1], o.regions[1]);
  EXPECT_EQ(store.block_summaries().size(), 2U * 28 * 2);
  std::size_t samples = 0;
  store.for_each_block(trials[3].id, [&](const SampleBlock& b) { samples += b.samples.size(); });
  EXPECT_EQ(samples, 750U);
  EXPECT_GT(store.block_summaries(trials[3].id)[0].peak_force, 1);
  EXPECT_TRUE(check_store(path_).empty());
  EXPECT_FALSE(fs::exists(path_.string() + "-wal")) << "a study at rest is one file";
}

TEST_F(StoreTest, AnAnswerIsGivenOnce) {
  Store store = Store::create(path_, study_);
  const std::string who = enrol(store);
  const std::int64_t session = store.begin_session(who);
  Answer a;
  a.pseudonym = who;
  a.key = "consent/given";
  a.value = "given";
  store.add_answer(session, 0, a);
  EXPECT_THROW(store.add_answer(session, 0, a), InputError);
}

// A limit on the size of files stands for the full disk; in a child, because it stays.
TEST_F(StoreTest, AFullDiskLeavesNothingHalfMade) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit little{8192, 8192};
    setrlimit(RLIMIT_FSIZE, &little);
    try {
      (void)Store::create(path_, study_);
    } catch (const FileError& error) {
      const std::string_view said = error.what();
      _exit(said.find("free some space") != said.npos ? 0 : 2);
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  for (const auto& left : fs::directory_iterator(path_.parent_path())) ADD_FAILURE() << left.path();
}

TEST_F(StoreTest, ASecondRunnerIsRefusedAReaderIsNot) {
  Store store = Store::create(path_, study_);
  const std::string who = enrol(store);
  EXPECT_NE(refusal(path_, Store::Access::run).find("another palpate"), std::string::npos);
  const Store reader = Store::open(path_, Store::Access::read);
  EXPECT_EQ(reader.participants().size(), 1U);
  run(store, who, "touch/1/rating");
  EXPECT_GT(reader.answers().size(), 10U);
  EXPECT_THROW((void)Store::create(path_, study_), InputError);
}

TEST_F(StoreTest, AWithdrawnParticipantIsGoneFromTheBytes) {
  const std::string secret = "zebra-comment-of-one-person";
  {
    Store store = Store::create(path_, study_);
    const std::string one = enrol(store), two = enrol(store);
    run(store, one, "", secret);
    run(store, two);
    EXPECT_NE((read_file(path_) + read_file(path_.string() + "-wal")).find(secret),
              std::string::npos);
    store.withdraw(one);
    EXPECT_EQ((read_file(path_) + read_file(path_.string() + "-wal")).find(secret),
              std::string::npos);
    EXPECT_THROW(store.withdraw("P007"), InputError);
  }
  EXPECT_EQ(read_file(path_).find(secret), std::string::npos);
  const Store store = Store::open(path_, Store::Access::read);
  const auto people = store.participants();
  EXPECT_EQ(people[0].state, ParticipantState::withdrawn);
  EXPECT_GT(people[0].withdrawn, 0);
  EXPECT_TRUE(people[0].background.empty());
  EXPECT_TRUE(store.answers("P001").empty());
  EXPECT_EQ(store.trials().size(), 28U);
  EXPECT_EQ(store.block_summaries().size(), 28U * 2);
  EXPECT_EQ(store.next_order_index(), 2);
  EXPECT_TRUE(check_store(path_).empty());
}

TEST_F(StoreTest, RefusesDamagedAndCutFilesAndLeavesThemAlone) {
  make();
  const std::string whole = read_file(path_);
  expect_refused_untouched("", "not a study file");
  expect_refused_untouched("Hello, this is not a database at all.", "not a study file");
  for (const double part : {0.001, 0.1, 0.5, 0.9, 0.999})
    expect_refused_untouched(
        whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))),
        "damaged");
  std::string broken = whole;
  for (std::size_t i = 4096; i < 4096 + 600; ++i) broken[i] = 'x';
  expect_refused_untouched(broken, "damaged");
  std::string other = whole;
  other[68] = 'X';  // the application's number
  expect_refused_untouched(other, "not a Palpate study");
  std::string later = whole;
  later[63] = 9;  // the last byte of the schema's version
  expect_refused_untouched(later, "format 9 of a later Palpate");
  EXPECT_NE(refusal(folder_ / "none.db", Store::Access::run).find("no such"), std::string::npos);
}

TEST_F(StoreTest, CheckFindsWhatSqliteDoesNot) {
  make();
  const auto edited = [&](const char* sql) {
    const fs::path copy = folder_ / "copy.db";
    fs::copy_file(path_, copy, fs::copy_options::overwrite_existing);
    sqlite3* db = nullptr;
    sqlite3_open(copy.c_str(), &db);
    EXPECT_EQ(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
    sqlite3_close(db);
    std::string all;
    for (const std::string& line : check_store(copy)) all += line + "\n";
    return all;
  };
  EXPECT_EQ(edited("SELECT 1"), "");
  EXPECT_NE(edited("UPDATE answer SET value = '9' WHERE key = 'touch/3/rating'")
                .find("touch/3/rating was changed"),
            std::string::npos);
  EXPECT_NE(edited("DELETE FROM answer WHERE key = 'touch/3/rating'").find("touch/3/rating"),
            std::string::npos);
  EXPECT_NE(edited("DELETE FROM samples WHERE trial = 5 AND sequence = 0").find("block 0"),
            std::string::npos);
  EXPECT_NE(edited("UPDATE samples SET data = zeroblob(length(data)) WHERE trial = 5 AND "
                   "sequence = 1")
                .find("check sum"),
            std::string::npos);
  EXPECT_NE(edited("UPDATE study SET protocol_text = protocol_text || ' '").find("protocol"),
            std::string::npos);
  EXPECT_NE(edited("UPDATE plan SET region = 'cheek' WHERE part = 'touch' AND place < 3")
                .find("permutation"),
            std::string::npos);
  EXPECT_NE(edited("PRAGMA foreign_keys = OFF; UPDATE trial SET region = 'chek' WHERE id = 3")
                .find("table trial"),
            std::string::npos);
}

// A version 1 file, made by version 1's own statements, with a block that has no summary yet.
TEST_F(StoreTest, AnOlderFileIsBroughtUpToDate) {
  make();
  sqlite3* db = nullptr;
  sqlite3_open(path_.c_str(), &db);
  EXPECT_EQ(sqlite3_exec(db,
                         "ALTER TABLE samples DROP COLUMN peak_force_n;"
                         "ALTER TABLE samples DROP COLUMN contact_s;"
                         "PRAGMA user_version = 1",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(db);
  EXPECT_NE(refusal(path_, Store::Access::read).find("palpate study upgrade"), std::string::npos);
  { (void)Store::open(path_, Store::Access::run); }
  const Store store = Store::open(path_, Store::Access::read);
  const auto blocks = store.block_summaries();
  ASSERT_EQ(blocks.size(), 56U);
  EXPECT_GT(blocks[0].peak_force, 1);
  EXPECT_GT(blocks[0].contact_s, 0.1);
  EXPECT_TRUE(check_store(path_).empty());
}

TEST_F(StoreTest, EverySchemaStepLeadsToTheNextVersion) {
  ASSERT_EQ(schema_steps().size(), static_cast<std::size_t>(kStoreVersion));
  Database db(folder_ / "v1.db", Database::Mode::create);
  db.run(schema_steps()[0].sql);
  db.run("PRAGMA user_version = 1");
  bring_up_to_date(db);
  EXPECT_EQ(db.number("PRAGMA user_version"), kStoreVersion);
  bring_up_to_date(db);
}

// A child is killed between any two commits; its parent finds all that was committed.
TEST_F(StoreTest, AKillLosesNothingThatWasCommitted) {
  { (void)Store::create(path_, study_); }
  std::size_t before = 0;
  for (int round = 0; round < 20; ++round) {
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      Store store = Store::open(path_, Store::Access::run, Store::Durability::process);
      const std::string who = enrol(store);
      const std::int64_t session = store.begin_session(who);
      for (int i = 0;; ++i) {
        Answer a;
        a.pseudonym = who;
        a.key = "k/" + std::to_string(i);
        a.value = std::string(200, 'v');
        store.add_answer(session, 0, a);
        if (write(pipe_ends[1], "x", 1) != 1) _exit(1);
      }
    }
    close(pipe_ends[1]);
    char byte = 0;
    std::size_t told = 0;
    const std::size_t enough = 1 + static_cast<std::size_t>(7 * round % 40);
    while (told < enough && read(pipe_ends[0], &byte, 1) == 1) ++told;
    kill(child, SIGKILL);
    while (read(pipe_ends[0], &byte, 1) == 1) ++told;
    close(pipe_ends[0]);
    waitpid(child, nullptr, 0);
    const Store store = Store::open(path_, Store::Access::run, Store::Durability::process);
    const std::size_t found = store.answers().size() - before;
    EXPECT_GE(found, told);
    EXPECT_LE(found, told + 1);
    before += found;
  }
}

}  // namespace
}  // namespace palpate::study
