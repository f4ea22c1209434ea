// SPDX-License-Identifier: Apache-2.0
// Recordings: bit-exact replay, crashes, damage, gaps.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "counters.hpp"
#include "haptics/cycle.hpp"
#include "haptics/recording_codec.hpp"
#include "haptics/simulated_hand.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

class Recorded : public testing::Test {
 protected:
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                ("palpate_recording_" + std::to_string(::getpid()) + ".touch");
  TouchModel model_ = make_touch_model(scenes::bumpy_head(30, 2.0));
  TickSetup setup_ = make_tick_setup(model_, *limits_of("falcon"));
  ~Recorded() override { std::filesystem::remove(path_); }

  void record(int ticks, int seconds_per_walk = 20) {
    SimulatedHandOptions o;
    o.limits = setup_.limits;
    o.repeat = true;
    o.resolution = 0.06;
    o.faults = {{HandFault::Kind::not_finite, 1.0, 1.1}, {HandFault::Kind::lost, 2.0, 2.1}};
    SimulatedHand hand(random_walk(model_, 7, seconds_per_walk, 150), o);
    Recorder recorder(path_, setup_, "simulated hand");
    TouchCycle cycle(setup_, hand, Workspace{}, {}, &recorder);
    std::int64_t now = 1'000'000'000;
    std::mt19937 rng(1);
    for (int i = 0; i < ticks; ++i) {
      now += 1'000'000 + static_cast<int>(rng() % 20000);
      cycle.advance(now, static_cast<int>(rng() % 90000));
      if (i % 2000 == 1999)  // as slow as the disk needs: the writer looks every 20 ms
        while (recorder.written() + 1500 < static_cast<std::uint64_t>(i))
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    recorder.finish();
    EXPECT_EQ(recorder.dropped(), 0U);
    EXPECT_EQ(recorder.written(), static_cast<std::uint64_t>(ticks));
  }
};

TEST_F(Recorded, TenMinutesReplayBitForBit) {
  record(600000, 600);
  const Recording r = read_recording(path_);
  EXPECT_TRUE(r.ending.empty()) << r.ending;
  const ReplayResult result = replay(r, model_);
  EXPECT_EQ(result.ticks, 600000U);
  EXPECT_EQ(result.different, 0U);
  EXPECT_EQ(result.gaps, 0U);
  std::size_t touching = 0;
  for (const RecordedBlock& b : r.blocks)
    for (const RecordedTick& t : b.ticks) touching += t.in_contact;
  EXPECT_GT(touching, 100000U);
  const double bytes = static_cast<double>(std::filesystem::file_size(path_)) / 600000;
  EXPECT_LT(bytes, 80);
  std::printf("%.1f bytes per tick, %zu ticks in contact\n", bytes, touching);
}

TEST_F(Recorded, AnotherHeadIsRefused) {
  record(1000);
  const TouchModel other = make_touch_model(scenes::bumpy_head(30, 2.1));
  EXPECT_THROW((void)replay(read_recording(path_), other), InputError);
}

TEST_F(Recorded, CutAnywhereKeepsTheWholeBlocks) {
  record(1600);
  const std::string bytes = read_file(path_);
  const Recording whole = parse_recording(bytes, "whole");
  ASSERT_EQ(whole.tick_count(), 1600U);
  const std::size_t header = codec::encode_header(whole.header).size();
  std::size_t refused = 0;
  for (std::size_t cut = 0; cut < bytes.size(); cut += cut < 2 * header ? 1 : 97) {
    const std::string_view part(bytes.data(), cut);
    try {
      const Recording r = parse_recording(part, "cut");
      EXPECT_LE(r.tick_count(), 1600U);
      EXPECT_EQ(r.tick_count() % 500, 0U);
      EXPECT_EQ(replay(r, model_).different, 0U);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_EQ(refused, header);
}

TEST_F(Recorded, DamageIsFoundAndTold) {
  record(1600);
  const std::string bytes = read_file(path_);
  std::mt19937 rng(4);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = bytes;
    damaged[rng() % damaged.size()] ^= static_cast<char>(1 + rng() % 255);
    try {
      const Recording r = parse_recording(damaged, "damaged");
      EXPECT_FALSE(r.ending.empty());
      EXPECT_LT(r.tick_count(), 1600U);
    } catch (const InputError&) {
    }
  }
}

// Ticks that were computed before come faster than any writer takes them.
TEST_F(Recorded, ASlowDiskLosesTicksButNotTheReplay) {
  constexpr std::size_t kTicks = 30000;
  SimulatedHandOptions o;
  o.repeat = true;
  SimulatedHand hand(random_walk(model_, 8, 20, 150), o);
  std::vector<TickState> states;
  std::vector<TickInput> inputs;
  std::vector<TickOutput> outputs;
  TickState state;
  DeviceSample sample;
  for (std::size_t i = 0; i < kTicks; ++i) {
    (void)hand.read(sample);
    TickInput input;
    input.position = sample.position;
    states.push_back(state);
    inputs.push_back(input);
    outputs.push_back(tick(setup_, input, state));
    (void)hand.write(outputs.back().force);
  }
  Recorder recorder(path_, setup_, "simulated hand");
  for (std::size_t i = 0; i < kTicks; ++i) {
    recorder.before_tick(states[i]);
    recorder.after_tick(inputs[i], outputs[i], {});
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  recorder.before_tick(states[0]);  // the disk is free again
  recorder.after_tick(inputs[0], outputs[0], {});
  recorder.finish();
  EXPECT_GT(recorder.dropped(), 0U);
  const Recording r = read_recording(path_);
  const ReplayResult result = replay(r, model_);
  EXPECT_EQ(result.different, 0U);
  EXPECT_EQ(result.ticks, recorder.written());
  EXPECT_EQ(result.ticks + recorder.dropped(), kTicks + 1);
  EXPECT_GE(result.gaps, 1U);
}

TEST_F(Recorded, TheLoopSideAllocatesAndLocksNothing) {
  SimulatedHandOptions o;
  o.repeat = true;
  SimulatedHand hand(random_walk(model_, 9, 20, 150), o);
  Recorder recorder(path_, setup_, "simulated hand");
  TouchCycle cycle(setup_, hand, Workspace{}, {}, &recorder);
  std::int64_t now = 1;
  const QuietScope quiet;
  for (int i = 0; i < 5000; ++i) cycle.advance(now += 1'000'000, 0);
  EXPECT_EQ(quiet.allocations(), 0);
  EXPECT_EQ(quiet.locks(), 0);
}

TEST_F(Recorded, CsvHasALinePerTick) {
  record(700);
  std::ostringstream out;
  write_csv(read_recording(path_), out);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 701);
  EXPECT_EQ(text.substr(0, 11), "time_s,x_mm");
}

TEST_F(Recorded, CannotBeCreatedIsAnError) {
  EXPECT_THROW(Recorder("/nowhere/at/all.touch", setup_, "x"), FileError);
}

TEST(Codec, DifferencesOfAnyWordsReturn) {
  std::mt19937_64 rng(2);
  codec::TickWords previous{}, words{}, back{};
  for (int i = 0; i < 1000; ++i) {
    for (auto& w : words) w = rng() >> (rng() % 64);
    std::string bytes;
    codec::put_difference(bytes, previous, words);
    std::string_view in = bytes;
    ASSERT_TRUE(codec::get_difference(in, previous, back));
    EXPECT_TRUE(in.empty());
    EXPECT_EQ(back, words);
    previous = words;
  }
}

TEST(Codec, Crc32OfTheCheckString) {
  EXPECT_EQ(codec::crc32("123456789"), 0xcbf43926U);
}

}  // namespace
}  // namespace palpate::haptics
