// SPDX-License-Identifier: GPL-3.0-or-later
// The runner against the store, and the simulated participant against its own law.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.hpp"
#include "study/runner.hpp"
#include "study/scenes.hpp"
#include "study/simulated_participant.hpp"

namespace palpate::study {
namespace {

class RunnerTest : public testing::Test {
 protected:
  scenes::Folder folder_;
  Protocol protocol_ = scenes::published();
  Study study_ = scenes::study_of(protocol_, 5);
  Store store_ = Store::create(folder_ / "study.db", study_, Store::Durability::process);

  std::string enrol() {
    return store_.enrol(false, draw_orders(protocol_, study_.regions, 5, store_.next_order_index()))
        .pseudonym;
  }
  static void go(Runner& runner, const std::string& until) {
    while (!runner.over() && runner.screen().key != until) {
      if (runner.screen().kind == ScreenKind::touch) (void)runner.pass(runner.screen().least_s);
      runner.answer(scenes::some_answer(runner.screen()));
    }
  }
  static std::vector<HapticSample> ticks(int from_ms, int count) {
    std::vector<HapticSample> all(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
      all[static_cast<std::size_t>(i)].time_us = 1000LL * (from_ms + i) + 77;
    return all;
  }
};

TEST_F(RunnerTest, TakesUpAtEveryScreenWithTheSameOrder) {
  const std::string one = enrol(), two = enrol();
  std::vector<std::string> straight, broken;
  {
    Runner runner(store_, protocol_, one);
    while (!runner.over()) {
      straight.push_back(runner.screen().key);
      go(runner, "none");
    }
  }
  // Each answer by another runner, as after a crash between any two.
  std::set<std::string> regions_before, regions_after;
  while (true) {
    Runner runner(store_, protocol_, two);
    if (runner.over()) break;
    const Screen before = runner.screen();
    broken.push_back(before.key);
    if (before.kind == ScreenKind::touch) (void)runner.pass(before.least_s);
    if (before.kind == ScreenKind::touch) EXPECT_FALSE(before.region.empty());
    runner.answer(scenes::some_answer(before));
  }
  EXPECT_GT(broken.size(), 60U);
  const auto answers = store_.answers(one), again = store_.answers(two);
  ASSERT_EQ(answers.size(), again.size());
  for (std::size_t i = 0; i < answers.size(); ++i) EXPECT_EQ(answers[i].key, again[i].key);
  for (const Participant& p : store_.participants()) EXPECT_EQ(p.state, ParticipantState::finished);
}

TEST_F(RunnerTest, ATrialThatWasCutIsDoneAgain) {
  const std::string who = enrol();
  std::string region;
  {
    Runner runner(store_, protocol_, who);
    go(runner, "touch/2");
    region = runner.screen().region;
    (void)runner.pass(0.7);
    runner.add_samples(ticks(0, 700));
  }
  Runner runner(store_, protocol_, who);
  EXPECT_EQ(runner.screen().key, "touch/2");
  EXPECT_EQ(runner.screen().region, region);
  EXPECT_EQ(runner.touched_s(), 0);
  go(runner, "touch/3");
  int attempts = 0;
  for (const TrialRecord& t : store_.trials())
    if (t.key == "touch/2") {
      ++attempts;
      EXPECT_EQ(t.last_attempt, t.attempt == 2);
      EXPECT_EQ(std::isnan(t.rating), t.attempt == 1);
      EXPECT_EQ(t.ended == 0, t.attempt == 1);
      if (t.attempt == 1) {
        std::size_t kept = 0;
        for (const SampleBlock& b : store_.block_summaries(t.id)) kept += b.count;
        EXPECT_EQ(kept, 700U);
      }
    }
  EXPECT_EQ(attempts, 2);
}

TEST_F(RunnerTest, BlocksAreHalfASecondAndTimesCountFromTheTouch) {
  Runner runner(store_, protocol_, enrol());
  go(runner, "touch/1");
  (void)runner.pass(0.1);
  runner.add_samples(ticks(9000, 1250));
  EXPECT_EQ(store_.block_summaries(runner.trial()).size(), 2U) << "written before the trial ends";
  (void)runner.pass(5);
  runner.answer("done");
  const auto blocks = store_.block_summaries(runner.trial());
  ASSERT_EQ(blocks.size(), 3U);
  std::int64_t first = -1, last = 0;
  store_.for_each_block(runner.trial(), [&](const SampleBlock& b) {
    if (first < 0) first = b.samples.front().time_us;
    last = b.samples.back().time_us;
    EXPECT_LE(b.samples.back().time_us - b.samples.front().time_us, 1'000'000);
  });
  EXPECT_EQ(first, 0);
  EXPECT_EQ(last, 1'249'000);
}

TEST_F(RunnerTest, TimersPauseAndRefusals) {
  Runner runner(store_, protocol_, enrol());
  go(runner, "tutorial/1/1");
  EXPECT_THROW(runner.answer("done"), InputError) << "ten seconds are asked for";
  EXPECT_FALSE(runner.pass(9));
  runner.pause(true);
  EXPECT_FALSE(runner.pass(100));
  EXPECT_THROW(runner.answer("done"), InputError);
  runner.pause(false);
  EXPECT_EQ(runner.touched_s(), 9);
  EXPECT_FALSE(runner.pass(1));
  EXPECT_TRUE(runner.may_go_on());
  EXPECT_TRUE(runner.pass(5)) << "fifteen seconds end it";
  EXPECT_EQ(runner.screen().key, "tutorial/1/2");
  go(runner, "touch/1/rating");
  EXPECT_THROW(runner.answer("12"), InputError);
  EXPECT_EQ(runner.screen().key, "touch/1/rating");
  runner.answer("7.5");
  const auto events = store_.events();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].kind, "pause");
  EXPECT_EQ(events[1].kind, "resume");
}

TEST_F(RunnerTest, WhoHasWithdrawnIsNotTakenUp) {
  const std::string who = enrol();
  { Runner runner(store_, protocol_, who); }
  store_.withdraw(who);
  EXPECT_THROW(Runner(store_, protocol_, who), InputError);
  EXPECT_THROW(Runner(store_, protocol_, "P999"), InputError);
}

// --- simulated participant

/// Stiffness of the regions without a hand.
double felt(const std::string& region, double factor) {
  static const Study study = scenes::study_of(scenes::published());
  for (const StudyRegion& r : study.regions)
    if (r.name == region) return factor * r.stiffness;
  return factor;
}

Answers simulate(const Protocol& p, const SimulationOptions& options, int index) {
  const Draw draw{draw_orders(p, scenes::study_of(p).regions, 5, index), 5, index};
  SimulatedParticipant mind(p, options, draw, felt);
  Answers answers;
  for (Screen s = next_screen(p, draw, answers);
       s.kind != ScreenKind::finished && s.kind != ScreenKind::excused;
       s = next_screen(p, draw, answers))
    answers[s.key] = checked_value(s, mind.answer(s));
  return answers;
}

TEST(SimulatedParticipants, AnswerEverythingAndTheSameAgain) {
  const Protocol p = scenes::published();
  const Answers one = simulate(p, {}, 3), again = simulate(p, {}, 3), other = simulate(p, {}, 4);
  EXPECT_TRUE(one.contains("closing/comments"));
  EXPECT_EQ(one, again);
  EXPECT_NE(one, other);
}

TEST(SimulatedParticipants, RateStifferPlacesHigher) {
  const Protocol p = scenes::published();
  const Study s = scenes::study_of(p);
  std::map<std::string, double> sum;
  for (int k = 0; k < 40; ++k) {
    const Answers answers = simulate(p, {}, k);
    for (const PlannedOrder& o : draw_orders(p, s.regions, 5, k))
      if (o.part == "touch")
        for (std::size_t i = 0; i < o.regions.size(); ++i)
          sum[o.regions[i]] +=
              std::stod(answers.at("touch/" + std::to_string(i + 1) + "/rating")) / 40;
  }
  for (std::size_t i = 1; i < p.analysis.reference_order.size(); ++i)
    EXPECT_GT(sum[p.analysis.reference_order[i - 1]], sum[p.analysis.reference_order[i]]);
  EXPECT_GT(sum["cranium"], 7);
  EXPECT_LT(sum["cheek"], 3);
}

// Three of four comparisons at the Weber fraction are right: binomial, 4 standard errors.
TEST(SimulatedParticipants, HaveTheWeberFractionThatTheyWereGiven) {
  const Protocol p = scenes::published();
  for (const double weber : {0.05, 0.15, 0.4}) {
    SimulationOptions options;
    options.weber = weber;
    SimulatedParticipant mind(p, options, {draw_orders(p, scenes::study_of(p).regions, 5, 0), 5, 0},
                              felt);
    constexpr int kCount = 20000;
    int right = 0;
    for (int i = 0; i < kCount; ++i) {
      const std::string key = std::to_string(i);
      right += mind.percept(key + "/2", "chin", 1 + weber) > mind.percept(key + "/1", "chin", 1);
    }
    EXPECT_NEAR(static_cast<double>(right) / kCount, 0.75, 4 * std::sqrt(0.75 * 0.25 / kCount));
  }
  EXPECT_THROW((void)simulation_json({.weber = 3}), InputError);
}

TEST(SimulatedParticipants, AStaircaseFindsTheirThreshold) {
  const Protocol p = scenes::discrimination();
  SimulationOptions options;
  options.weber = 0.2;
  double sum = 0;
  int count = 0;
  for (int k = 0; k < 30; ++k) {
    const Answers answers = simulate(p, options, k);
    for (int series = 1; series <= 2; ++series) {
      std::vector<bool> right;
      const Draw draw{draw_orders(p, scenes::study_of(p).regions, 5, k), 5, k};
      Answers so_far = answers;
      for (int trial = 1;; ++trial) {
        const std::string key =
            "compare/" + std::to_string(series) + "/" + std::to_string(trial) + "/stiffer";
        if (!so_far.contains(key)) break;
        Answers before = so_far;
        before.erase(key);
        const Screen s = next_screen(p, draw, before);
        ASSERT_EQ(s.key, key);
        const double level = staircase_after(p.parts[3].staircase, right).difference;
        right.push_back((s.factors[0] > s.factors[1]) == (answers.at(key) == "1"));
        if (trial > 20) {
          sum += std::log(level);
          ++count;
        }
      }
    }
  }
  // 79.4 % correct lies at z = 0.8202 where the Weber fraction lies at 0.6745.
  const double expected = std::expm1(std::log1p(0.2) * 0.8202 / 0.6745);
  EXPECT_NEAR(std::exp(sum / count), expected, 0.2 * expected);
}

}  // namespace
}  // namespace palpate::study
