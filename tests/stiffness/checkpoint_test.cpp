// SPDX-License-Identifier: GPL-3.0-or-later
// A long run may be killed, split, damaged or run out of disk; its result stays the same bits.
#include "stiffness/checkpoint.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "scenes.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {
namespace {
namespace fs = std::filesystem;

class CheckpointFile : public testing::Test {
 protected:
  fs::path folder;
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("palpate_checkpoint_") +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
};

SiteCurve curve(double scale) {
  SiteCurve c;
  c.travel = {scale, 1.7 * scale};
  c.sunk = {scale, 0.5 * scale, 0.9 * scale, 0.1};
  c.method = SolveMethod::batch;
  c.iterations = 7;
  c.residual = 1e-5 * scale;
  return c;
}

void fill(const fs::path& path, int blocks) {
  Checkpoint store(path, 42);
  for (std::int32_t b = 0; b < blocks; ++b) {
    const std::vector<std::int32_t> sites = {2 * b, 2 * b + 1};
    const std::vector<SiteCurve> curves = {curve(1 + b), curve(2.5 + b)};
    store.put(SolveLevel::full, sites, curves);
  }
}

void write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(CheckpointFile, GivesBackWhatItWasGiven) {
  fill(folder / "a", 3);
  Checkpoint store(folder / "a", 42);
  EXPECT_EQ(store.size(), 6u);
  EXPECT_EQ(store.find(SolveLevel::coarse, 0), nullptr);
  const SiteCurve* c = store.find(SolveLevel::full, 5);
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->travel, curve(4.5).travel);
  EXPECT_EQ(c->sunk, curve(4.5).sunk);
  EXPECT_EQ(c->method, SolveMethod::batch);
  EXPECT_EQ(c->iterations, 7);
  EXPECT_EQ(c->residual, curve(4.5).residual);
  EXPECT_TRUE(store.damage().empty());
}

TEST_F(CheckpointFile, CutAtEveryByteKeepsTheWholeBlocksAndGoesOn) {
  fill(folder / "whole", 3);
  const std::string bytes = read_file(folder / "whole");
  std::size_t before = 0;
  for (std::size_t length = 0; length <= bytes.size();
       length += length < 60 ? std::size_t{1} : std::size_t{7}) {
    write(folder / "cut", bytes.substr(0, length));
    {
      Checkpoint store(folder / "cut", 42);
      EXPECT_GE(store.size(), before);
      before = store.size();
      EXPECT_TRUE(store.damage().empty());
      store.put(SolveLevel::coarse, std::vector<std::int32_t>{9}, std::vector<SiteCurve>{curve(3)});
    }
    Checkpoint again(folder / "cut", 42);
    EXPECT_EQ(again.size(), before + 1);
  }
  EXPECT_GE(before, 4u);
}

TEST_F(CheckpointFile, DamageCostsItsBlockAlone) {
  fill(folder / "whole", 3);
  const std::string bytes = read_file(folder / "whole");
  const std::size_t header = 36, block = (bytes.size() - header) / 3;
  std::string bad = bytes;
  bad[header + block + 40] = static_cast<char>(bad[header + block + 40] ^ 0x10);
  write(folder / "bad", bad);
  Checkpoint store(folder / "bad", 42);
  EXPECT_EQ(store.size(), 4u);
  EXPECT_EQ(store.find(SolveLevel::full, 2), nullptr);
  EXPECT_NE(store.find(SolveLevel::full, 4), nullptr);
  ASSERT_EQ(store.damage().size(), 1u);
  EXPECT_NE(store.damage()[0].find("damaged"), std::string::npos);
}

TEST_F(CheckpointFile, RefusesOtherJobsOtherFilesAndSecondWriters) {
  fill(folder / "a", 1);
  EXPECT_THROW(Checkpoint(folder / "a", 43), InputError);
  write(folder / "text", std::string(100, 'x'));
  EXPECT_THROW(Checkpoint(folder / "text", 42), InputError);
  const Checkpoint first(folder / "a", 42);
  EXPECT_THROW(Checkpoint(folder / "a", 42), FileError);
  EXPECT_THROW(Checkpoint(folder / "no" / "such", 42), FileError);
}

TEST_F(CheckpointFile, AFullDiskLosesNothingThatWasStored) {
  fill(folder / "a", 3);
  const auto size = fs::file_size(folder / "a");
  struct rlimit usual;
  getrlimit(RLIMIT_FSIZE, &usual);
  signal(SIGXFSZ, SIG_IGN);
  {
    Checkpoint store(folder / "a", 42);
    const struct rlimit tight = {size + 50, usual.rlim_max};
    setrlimit(RLIMIT_FSIZE, &tight);
    try {
      store.put(SolveLevel::full, std::vector<std::int32_t>{9}, std::vector<SiteCurve>{curve(3)});
      ADD_FAILURE() << "the write should have failed";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("6 curves before this are safe"), std::string::npos);
    }
    setrlimit(RLIMIT_FSIZE, &usual);
  }
  EXPECT_EQ(Checkpoint(folder / "a", 42).size(), 6u);
}

struct LongRun : CheckpointFile {
  scenes::Head head = scenes::head(2);
  SkinPoints points;
  LongRun() {  // enough for three batches of coarse presses and two of full ones
    points.position.assign(head.skin.skin.points.begin(), head.skin.skin.points.begin() + 40);
    points.region.assign(40, SkinRegion::cheek);
  }
  Sweep run(const SweepOptions& o, const Progress& progress = {}) const {
    return sweep(head.skin, head.skull, points, o, progress);
  }
  SweepOptions options() const {
    SweepOptions o;
    o.mode = SweepMode::fast;
    o.loads = 1;
    o.max_force = 1;
    o.sites = 20;
    o.threads = 2;
    o.error_bound = 1;
    return o;
  }
};

TEST_F(LongRun, StoppedAnywhereItGoesOnToTheSameBits) {
  const Sweep whole = run(options());
  SweepOptions o = options();
  o.checkpoint = folder / "run";
  for (const double stop_at : {0.2, 0.5, 0.8}) {
    std::atomic<bool> stop = false;
    const Progress progress([&](std::string_view, double f) { stop = stop || f > stop_at; }, &stop);
    EXPECT_THROW((void)run(o, progress), Cancelled);
  }
  const auto kept = fs::file_size(o.checkpoint);
  fs::resize_file(o.checkpoint, kept - 5);  // as if killed while writing
  const Sweep resumed = run(o);
  EXPECT_GT(kept, 1000u);
  EXPECT_EQ(resumed.map.displacement, whole.map.displacement);
  EXPECT_EQ(resumed.map.error, whole.map.error);
  EXPECT_EQ(resumed.map.dents.share, whole.map.dents.share);
  EXPECT_EQ(resumed.statistics, whole.statistics);
}

TEST_F(LongRun, ShardsMergeToTheSameBits) {
  const Sweep whole = run(options());
  SweepOptions merge = options();
  for (int i = 0; i < 2; ++i) {
    SweepOptions o = options();
    o.shard = i;
    o.shard_count = 2;
    o.checkpoint = folder / std::to_string(i);
    const Sweep part = run(o);
    EXPECT_TRUE(part.map.status.empty());
    EXPECT_LT(part.statistics.at("curves_in_store"), 60);
    merge.parts.push_back(o.checkpoint);
  }
  const Sweep merged = run(merge);
  EXPECT_EQ(merged.map.displacement, whole.map.displacement);
  EXPECT_EQ(merged.map.status, whole.map.status);
  EXPECT_EQ(merged.statistics, whole.statistics);
  merge.tool_radius = 7;  // another job: its parts do not fit
  EXPECT_THROW((void)run(merge), InputError);
}

}  // namespace
}  // namespace palpate::stiffness
