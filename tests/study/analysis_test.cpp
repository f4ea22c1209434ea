// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "published_study.hpp"
#include "study/export.hpp"
#include "study/table_text.hpp"

namespace palpate::study {
namespace {

TEST(Analysis, RationalityIsThePublishedTable) {
  const Results r = analyse(test::published_study());
  ASSERT_EQ(r.rationality.size(), 1U);
  const Rationality& one = r.rationality[0];
  EXPECT_NEAR(one.ratings.moments.mean, 8.6, 1e-12);
  EXPECT_NEAR(one.ratings.moments.sd, 0.957, 5e-4);
  EXPECT_NEAR(one.t.t, 3.133, 5e-4);
  EXPECT_EQ(one.t.df, 24);
  EXPECT_NEAR(one.t.p, 0.0045, 5e-5);
  EXPECT_EQ(one.wilcoxon.zeros, 6U);
}

TEST(Analysis, GroupsAreThoseOfTheBackground) {
  const Results r = analyse(test::published_study());
  ASSERT_EQ(r.groupings.size(), 2U);
  const Grouping& g = r.groupings[0];
  EXPECT_TRUE(g.planned);
  EXPECT_EQ(g.levels, (std::vector<std::string>{"novice", "experienced"}));
  EXPECT_EQ(g.sizes, (std::vector<std::size_t>{18, 7}));
  ASSERT_EQ(g.tests.size(), 8U);  // seven regions and rationality
  EXPECT_EQ(g.tests.back().quantity, "rationality");
  EXPECT_NEAR(g.tests.back().a.moments.mean, 8.78, 5e-3);
  EXPECT_NEAR(g.tests.back().b.moments.mean, 8.14, 5e-3);
  EXPECT_GT(g.tests.back().welch.p, 0.05);
  EXPECT_TRUE(std::isnan(g.tests.back().welch_holm));  // not of the family of regions
  for (std::size_t k = 0; k < 7; ++k) EXPECT_GE(g.tests[k].welch_holm, g.tests[k].welch.p);
  // Only one person is left-handed: described, not tested.
  EXPECT_FALSE(r.groupings[1].planned);
  EXPECT_TRUE(r.groupings[1].tests.empty());
}

TEST(Analysis, GroupMeansCombineToTheTotals) {
  const Results r = analyse(test::published_study());
  const Condition& both = r.conditions.back();
  ASSERT_EQ(both.id, "both");
  for (std::size_t k = 0; k < r.regions.size(); ++k) {
    std::vector<st::Moments> groups;
    for (const auto& level : r.groupings[0].by_level) groups.push_back(level[k].moments);
    const st::Moments all = st::combined(groups);
    EXPECT_NEAR(all.mean, both.regions[k].moments.mean, 1e-12);
    EXPECT_NEAR(all.sd, both.regions[k].moments.sd, 1e-12);
  }
}

TEST(Analysis, SightMovesOnlyTheCheek) {
  const Results r = analyse(test::published_study());
  ASSERT_EQ(r.paired.size(), 7U);
  for (const PairedTest& t : r.paired) {
    if (t.region != "cheek") {
      EXPECT_EQ(t.t.difference, 0);
      EXPECT_EQ(t.wilcoxon.zeros, 25U);
      EXPECT_TRUE(std::isnan(t.t.p));  // nobody differs: no spread, no test
      continue;
    }
    EXPECT_NEAR(t.t.difference, 0.5, 1e-12);
    EXPECT_EQ(t.wilcoxon.rank_biserial, 1);
    EXPECT_LT(t.wilcoxon_holm, 1e-4);
  }
}

TEST(Analysis, SelectionsCountChoicesAndPeople) {
  const Results r = analyse(test::published_study());
  ASSERT_EQ(r.selections.size(), 4U);
  const Selection& tough = r.selections[0];
  EXPECT_EQ(tough.experiment, "touch");
  EXPECT_EQ(tough.right, (std::vector<std::string>{"cranium", "forehead"}));
  EXPECT_EQ(tough.choices.successes, 45U);  // of 50: five people chose the eyebrow
  EXPECT_EQ(tough.choices.trials, 50U);
  EXPECT_EQ(tough.people.successes, 20U);
  EXPECT_EQ(tough.regions[2].successes, 5U);
  EXPECT_EQ(r.selections[1].right, (std::vector<std::string>{"cheek", "chin"}));
  EXPECT_EQ(r.selections[3].choices.share, 1);
}

TEST(Analysis, RankingAndCorrelationOfAPerfectOrder) {
  const Results r = analyse(test::published_study());
  ASSERT_EQ(r.rankings.size(), 2U);
  EXPECT_EQ(r.rankings[0].perfect, 25U);
  EXPECT_EQ(r.rankings[0].accuracy.moments.mean, 1);
  EXPECT_EQ(r.rankings[0].of_means.tau_b, 1);
  EXPECT_EQ(r.rankings[0].of_means.form, st::RankForm::exact);
  ASSERT_EQ(r.felt.size(), 2U);
  EXPECT_NEAR(r.felt[0].spearman.r, 1, 1e-12);
  EXPECT_GT(r.felt[0].pearson_log.r, r.felt[0].pearson.r);
  EXPECT_GT(r.felt[0].line.slope, 0);
}

TEST(Analysis, OnlyTheFinishedCount) {
  StudyData data = test::published_study();
  data.participants[0].state = ParticipantState::withdrawn;
  data.participants[1].state = ParticipantState::excused;
  data.participants[2].state = ParticipantState::running;
  const Results r = analyse(data);
  EXPECT_EQ(r.people.size(), 22U);
  EXPECT_EQ(r.withdrawn, 1U);
  EXPECT_EQ(r.excused, 1U);
  EXPECT_EQ(r.unfinished, 1U);
  EXPECT_EQ(r.conditions[0].regions[0].moments.n, 22U);
  EXPECT_EQ(r.selections[0].people.trials, 22U);
}

TEST(Analysis, OfNobodyIsEmptyAndNotANumber) {
  StudyData data = test::published_study();
  for (Participant& p : data.participants) p.state = ParticipantState::enrolled;
  const Results r = analyse(data);
  EXPECT_TRUE(r.people.empty());
  EXPECT_TRUE(r.conditions.empty());
  EXPECT_TRUE(r.rationality.empty());
  EXPECT_TRUE(r.selections.empty());
}

TEST(Analysis, MissingRatingsAreLeftOutAndCounted) {
  StudyData data = test::published_study();
  for (TrialRecord& t : data.trials)
    if (t.pseudonym == "P101" && t.region == "jaw" && t.experiment == "touch") t.rating = kNothing;
  const Results r = analyse(data);
  const auto jaw = static_cast<std::size_t>(std::find(r.regions.begin(), r.regions.end(), "jaw") -
                                            r.regions.begin());
  EXPECT_EQ(r.conditions[0].regions[jaw].moments.n, 24U);
  EXPECT_EQ(r.conditions[1].regions[jaw].moments.n, 25U);
  EXPECT_EQ(r.rankings[0].pair_accuracy[0], 1);  // over the six that are there
}

TEST(Analysis, WeberFractionsOfSimulatedStaircases) {
  StudyData data = test::published_study();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> chance(0, 1), level(0.05, 0.6);
  for (const Participant& p : data.participants)
    for (int i = 1; i <= 60; ++i) {
      Comparison c{p.pseudonym, "compare", "cheek", i, level(random), 1 + i % 2, 1};
      const bool right = chance(random) < st::share_correct(c.difference, 0.2, 0.02);
      c.answered = right ? c.stiffer : 3 - c.stiffer;
      data.comparisons.push_back(c);
    }
  const Discrimination d = analyse(data).discrimination;
  ASSERT_EQ(d.rows.size(), 25U);
  EXPECT_NEAR(d.geometric_mean, 0.2, 0.03);
  EXPECT_LT(d.interval.low, 0.2);
  EXPECT_GT(d.interval.high, 0.2);
  std::size_t choices = 0;
  for (const LevelShare& l : d.levels) choices += l.correct.trials;
  EXPECT_EQ(choices, 25U * 60U);
}

const ExportFile& file_of(const std::vector<ExportFile>& files, const std::string& path) {
  for (const ExportFile& f : files)
    if (f.path == path) return f;
  throw std::runtime_error("no file " + path);
}
std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Export, TidyTablesHaveOneRowPerObservation) {
  const StudyData data = test::published_study();
  const auto files = tidy_tables(data, analyse(data));
  EXPECT_EQ(lines(file_of(files, "tables/trials.csv").text), 1 + 25U * 14U);
  EXPECT_EQ(lines(file_of(files, "tables/selections.csv").text), 1 + 25U * 8U);
  EXPECT_EQ(lines(file_of(files, "tables/participants.csv").text), 26U);
  const std::string& tests = file_of(files, "tables/tests.csv").text;
  EXPECT_NE(tests.find("one-sample t"), std::string::npos);
  EXPECT_NE(tests.find("\"normal approximation, corrected for ties and continuity\""),
            std::string::npos);
  // Every row has as many cells as the head.
  for (const ExportFile& f : files) {
    std::size_t from = 0, wanted = 0;
    while (from < f.text.size()) {
      std::size_t cells = 1;
      bool quoted = false;
      for (; f.text[from] != '\n' || quoted; ++from) {
        quoted ^= f.text[from] == '"';
        cells += f.text[from] == ',' && !quoted;
      }
      ++from;
      if (wanted == 0) wanted = cells;
      ASSERT_EQ(cells, wanted) << f.path;
    }
  }
}

TEST(Export, BidsHasASidecarForEveryColumn) {
  const StudyData data = test::published_study();
  const auto files = bids_files(data);
  EXPECT_EQ(lines(file_of(files, "bids/participants.tsv").text), 26U);
  EXPECT_EQ(lines(file_of(files, "bids/sub-P101/beh/sub-P101_task-sight_beh.tsv").text), 8U);
  for (const auto& [table, sidecar] :
       {std::pair{"bids/participants.tsv", "bids/participants.json"},
        std::pair{"bids/sub-P101/beh/sub-P101_task-touch_beh.tsv", "bids/task-touch_beh.json"}}) {
    const std::string& text = file_of(files, table).text;
    const std::string& json = file_of(files, sidecar).text;
    std::string head = text.substr(0, text.find('\n')) + '\t';
    for (std::size_t tab = head.find('\t'); tab != std::string::npos; tab = head.find('\t')) {
      EXPECT_NE(json.find('"' + head.substr(0, tab) + '"'), std::string::npos)
          << head.substr(0, tab);
      head.erase(0, tab + 1);
    }
  }
}

TEST(Export, SimulatedPeopleAreMarkedEverywhere) {
  StudyData data = test::published_study();
  data.study.simulated = true;
  for (Participant& p : data.participants) p.simulated = true;
  for (const ExportFile& f : tidy_tables(data, analyse(data))) {
    EXPECT_NE(f.text.substr(0, f.text.find('\n')).find("simulated"), std::string::npos) << f.path;
    EXPECT_EQ(f.text.find(",no,novice"), std::string::npos) << f.path;
  }
  const auto bids = bids_files(data);
  EXPECT_NE(file_of(bids, "bids/dataset_description.json").text.find("simulated participants"),
            std::string::npos);
  EXPECT_NE(file_of(bids, "bids/task-touch_beh.json").text.find("\"Simulated\": true"),
            std::string::npos);
  EXPECT_NE(file_of(bids, "bids/README").text.find("programs, not people"), std::string::npos);
}

TEST(TableText, QuotesWhatCsvMustAndSpreadsheetsWouldRun) {
  CsvText csv{"a", "b"};
  csv.row({"x,y", "say \"no\"\nor yes"});
  csv.row({"=1+1", "-0.5"});
  EXPECT_EQ(std::move(csv).text(), "a,b\n\"x,y\",\"say \"\"no\"\"\nor yes\"\n'=1+1,-0.5\n");
  TsvText tsv({"a", "b"});
  tsv.row({"x\ty\n", ""});
  EXPECT_EQ(std::move(tsv).text(), "a\tb\nx y \tn/a\n");
  EXPECT_EQ(number_cell(0.1), "0.1");
  EXPECT_EQ(number_cell(kNothing, "n/a"), "n/a");
  EXPECT_EQ(number_cell(-0.0), "0");
  EXPECT_EQ(utc_text(0), "");
  EXPECT_EQ(utc_text(1709210096007), "2024-02-29T12:34:56.007Z");
}

}  // namespace
}  // namespace palpate::study
