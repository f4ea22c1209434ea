// SPDX-License-Identifier: GPL-3.0-or-later
// Orders, the walk through a protocol, the staircase.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/error.hpp"
#include "study/random.hpp"
#include "study/run.hpp"
#include "study/scenes.hpp"

namespace palpate::study {
namespace {

TEST(Orders, WilliamsRowsBalancePlacesAndNeighbours) {
  for (int n = 1; n <= 12; ++n) {
    const auto rows = balanced_rows(n);
    const std::size_t copies = n == 1 || n % 2 == 0 ? 1 : 2;
    EXPECT_EQ(rows.size(), copies * static_cast<std::size_t>(n));
    std::map<std::pair<int, int>, std::size_t> at_place, follows;
    for (const auto& row : rows) {
      EXPECT_EQ(std::set<int>(row.begin(), row.end()).size(), static_cast<std::size_t>(n));
      for (std::size_t i = 0; i < row.size(); ++i) {
        ++at_place[{static_cast<int>(i), row[i]}];
        if (i > 0) ++follows[{row[i - 1], row[i]}];
      }
    }
    for (const auto& [where, count] : at_place) EXPECT_EQ(count, copies);
    EXPECT_EQ(follows.size(), static_cast<std::size_t>(n * (n - 1)));
    for (const auto& [pair, count] : follows) EXPECT_EQ(count, copies) << n;
  }
}

TEST(Orders, FourteenParticipantsSeeEachRegionTwiceAtEachPlace) {
  const Protocol p = scenes::published();
  const Study s = scenes::study_of(p);
  std::map<std::pair<std::size_t, std::string>, int> count;
  for (int k = 14; k < 28; ++k)
    for (const PlannedOrder& o : draw_orders(p, s.regions, 7, k))
      if (o.part == "touch")
        for (std::size_t i = 0; i < o.regions.size(); ++i) ++count[{i, o.regions[i]}];
  EXPECT_EQ(count.size(), 49U);
  for (const auto& [where, n] : count) EXPECT_EQ(n, 2);
}

TEST(Orders, ComeFromTheSeedAlone) {
  const Protocol p = scenes::published();
  const Study s = scenes::study_of(p);
  const auto regions = [&](std::uint64_t seed, int index) {
    std::vector<std::string> all;
    for (const PlannedOrder& o : draw_orders(p, s.regions, seed, index))
      all.insert(all.end(), o.regions.begin(), o.regions.end());
    return all;
  };
  EXPECT_EQ(regions(5, 3), regions(5, 3));
  EXPECT_NE(regions(5, 3), regions(6, 3));
  EXPECT_NE(regions(5, 3), regions(5, 4));
  const auto orders = draw_orders(p, s.regions, 5, 3);
  ASSERT_EQ(orders[1].part, "tutorial");
  EXPECT_EQ(orders[1].regions, p.analysis.reference_order) << "from stiff to soft";
}

TEST(Random, IsEvenAndAddressed) {
  Random r(1, "x", 2, 3);
  std::array<int, 7> seen{};
  for (int i = 0; i < 70000; ++i) ++seen[r.below(7)];
  for (const int n : seen) EXPECT_NEAR(n, 10000, 400);
  double sum = 0, squares = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = r.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / 1e5, 0, 0.015);
  EXPECT_NEAR(squares / 1e5, 1, 0.02);
  EXPECT_EQ(Random(1, "x", 2, 3).next(), Random(1, "x", 2, 3).next());
  EXPECT_NE(Random(1, "x", 2, 3).next(), Random(1, "x", 3, 2).next());
}

std::vector<Screen> walk(const Protocol& p, const Draw& draw,
                         const std::map<std::string, std::string>& special = {}) {
  Answers answers;
  std::vector<Screen> seen;
  while (true) {
    const Screen s = next_screen(p, draw, answers);
    seen.push_back(s);
    if (s.kind == ScreenKind::finished || s.kind == ScreenKind::excused) return seen;
    const auto given = special.find(s.key);
    answers[s.key] =
        checked_value(s, given == special.end() ? scenes::some_answer(s) : given->second);
  }
}
Draw draw_of(const Protocol& p, int index = 0) {
  return {draw_orders(p, scenes::study_of(p).regions, 1, index), 1, index};
}
std::size_t touches(const std::vector<Screen>& seen, const std::string& part) {
  return static_cast<std::size_t>(std::count_if(seen.begin(), seen.end(), [&](const Screen& s) {
    return s.kind == ScreenKind::touch && s.part == part;
  }));
}

TEST(Run, ThePublishedStudyGoesAsPublished) {
  const Protocol p = scenes::published();
  const auto seen = walk(p, draw_of(p));
  EXPECT_EQ(seen.front().kind, ScreenKind::consent);
  EXPECT_EQ(seen.back().kind, ScreenKind::finished);
  EXPECT_EQ(touches(seen, "tutorial"), 14U);
  EXPECT_EQ(touches(seen, "touch"), 7U);
  EXPECT_EQ(touches(seen, "sight"), 7U);
  std::set<std::string> keys;
  for (const Screen& s : seen) EXPECT_TRUE(keys.insert(s.key).second) << s.key;
  for (const char* key : {"touch/1/rating", "touch/7/rating", "touch/toughest", "touch/softest",
                          "sight/7/where", "rationality/realism", "closing/comments"})
    EXPECT_TRUE(keys.contains(key)) << key;
  EXPECT_FALSE(keys.contains("touch/1/where"));
}

TEST(Run, TheGateAdmitsAfterASecondTutorialOrExcuses) {
  const Protocol p = scenes::published();
  const auto again = walk(p, draw_of(p), {{"tutorial/gate", "no"}});
  EXPECT_EQ(touches(again, "tutorial"), 28U);
  EXPECT_EQ(again.back().kind, ScreenKind::finished);
  const auto excused =
      walk(p, draw_of(p), {{"tutorial/gate", "no"}, {"tutorial/gate-again", "no"}});
  EXPECT_EQ(excused.back().kind, ScreenKind::excused);
  EXPECT_EQ(touches(excused, "touch"), 0U);
  const auto refused = walk(p, draw_of(p), {{"consent/given", "refused"}});
  EXPECT_EQ(refused.size(), 2U);
}

TEST(Run, RefusesAnswersThatCannotBe) {
  const Protocol p = scenes::published();
  for (const Screen& s : walk(p, draw_of(p))) {
    const auto refuses = [&](const std::string& value) {
      EXPECT_THROW((void)checked_value(s, value), InputError) << s.key << " took " << value;
    };
    if (s.key == "touch/3/rating") {
      for (const char* bad : {"", "0", "11", "5.25", "five", "5x", "nan", "-1"}) refuses(bad);
      EXPECT_EQ(checked_value(s, "5.50"), "5.5");
      EXPECT_EQ(checked_value(s, "10"), "10");
    }
    if (s.key == "touch/toughest") {
      for (const char* bad : {"", "1", "1,1", "1,2,3", "0,1", "1,8", "a,b", "1,2,"})
        if (std::string(bad) != "1,2,") refuses(bad);
      EXPECT_EQ(checked_value(s, "7,2"), "2,7");
    }
    if (s.key == "touch/softest") {
      EXPECT_EQ(s.barred, (std::vector{1, 2}));
      refuses("2,3");
    }
    if (s.key == "background/age") refuses("17");
    if (s.key == "background/gender") refuses("woman ");
    if (s.key == "consent/given") refuses("");
  }
}

// Rules by hand: 3 right make it harder, each wrong easier; fine steps after the second reversal.
TEST(Staircase, FollowsTheUpDownRule) {
  Staircase o;
  o.start = 0.64;
  o.step = 2;
  o.fine_step = 1.25;
  const auto level = [&](const std::string& given) {
    std::vector<bool> right;
    for (const char c : given) right.push_back(c == '+');
    return staircase_after(o, right);
  };
  EXPECT_DOUBLE_EQ(level("").difference, 0.64);
  EXPECT_DOUBLE_EQ(level("++").difference, 0.64);
  EXPECT_DOUBLE_EQ(level("+++").difference, 0.32);
  EXPECT_DOUBLE_EQ(level("+++-").difference, 0.64);
  EXPECT_EQ(level("+++-").reversals, 1);
  EXPECT_DOUBLE_EQ(level("+++-+++").difference, 0.64 / 1.25);
  EXPECT_EQ(level("+++-+++").reversals, 2);
  EXPECT_DOUBLE_EQ(level("----------").difference, o.most);
  EXPECT_TRUE(level(std::string(80, '+')).over);
  EXPECT_DOUBLE_EQ(level(std::string(79, '+')).difference, o.least);
}

// An observer with a known threshold is found: the mean level settles at 79.4 % correct.
TEST(Staircase, SettlesWhereFourOfFiveAreRight) {
  const Staircase o;
  double sum = 0;
  int count = 0;
  for (std::uint64_t run = 0; run < 400; ++run) {
    Random chance(9, "observer", run);
    std::vector<bool> right;
    for (StaircaseState s = staircase_after(o, right); !s.over; s = staircase_after(o, right)) {
      const double sigma = 0.14;  // of ln stiffness, each press
      const double seen = std::log1p(s.difference) / sigma + std::sqrt(2.0) * chance.normal();
      right.push_back(seen > 0);
      if (s.reversals >= 4) {
        sum += std::log(s.difference);
        ++count;
      }
    }
  }
  const double expected = std::expm1(0.14 * std::sqrt(2.0) * 0.8202);  // z of 0.794
  EXPECT_NEAR(std::exp(sum / count), expected, 0.15 * expected);
}

TEST(Run, TheDiscriminationEndsAndHidesTheStifferOne) {
  const Protocol p = scenes::discrimination();
  const auto seen = walk(p, draw_of(p));
  EXPECT_EQ(seen.back().kind, ScreenKind::finished);
  int first = 0, trials = 0;
  for (std::size_t i = 0; i + 1 < seen.size(); ++i)
    if (seen[i].interval == 1) {
      ++trials;
      ASSERT_EQ(seen[i + 1].interval, 2);
      EXPECT_TRUE((seen[i].factor == 1) != (seen[i + 1].factor == 1));
      first += seen[i].factor > 1;
    }
  EXPECT_GT(trials, 20);
  EXPECT_GT(first, trials / 5);
  EXPECT_LT(first, 4 * trials / 5);
}

}  // namespace
}  // namespace palpate::study
