// SPDX-License-Identifier: GPL-3.0-or-later
// palpate study analyse on study files that the runner wrote, with simulated participants.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "study/runner.hpp"
#include "study/simulated_participant.hpp"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;

/// Stiff to soft as the published order; each a quarter softer than the one before.
double stiffness_of(const Protocol& protocol, const std::string& region) {
  auto order = protocol.analysis.reference_order;
  if (order.empty()) order = protocol.regions;
  double stiffness = 2;
  for (const std::string& r : order) {
    if (r == region) break;
    stiffness *= 0.75;
  }
  return stiffness;
}

/// A study of `people` simulated participants; three seconds of samples in each touch.
void make_study(const fs::path& file, const std::string& protocol_name, int people) {
  const Protocol protocol =
      read_protocol(fs::path(PALPATE_SOURCE_DIR) / "protocols" / protocol_name);
  Study s;
  s.id = std::string(32, 'a');
  s.title = protocol.title;
  s.protocol_name = protocol.name;
  s.protocol_text = protocol.text;
  s.head_name = "<head> & co.glb";
  s.head_fingerprint = "f";
  s.seed = 1;
  s.program = "test";
  s.created = now();
  s.planned_participants = people;
  s.simulated = true;
  SimulationOptions options;
  s.simulation = simulation_json(options);
  for (const std::string& name : protocol.regions) {
    StudyRegion r;
    r.name = name;
    r.stiffness = r.stiffness_at_point = stiffness_of(protocol, name);
    s.regions.push_back(r);
  }
  Store store = Store::create(file, s, Store::Durability::process);
  for (int i = 0; i < people; ++i) {
    const auto orders = draw_orders(protocol, s.regions, s.seed, store.next_order_index());
    const Participant p = store.enrol(true, orders);
    Runner runner(store, protocol, p.pseudonym);
    SimulatedParticipant person(protocol, options, runner.draw(),
                                [&](const std::string& region, double factor) {
                                  return factor * stiffness_of(protocol, region);
                                });
    while (!runner.over()) {
      if (runner.screen().kind == ScreenKind::touch) {
        const std::string key = runner.screen().key;
        while (!runner.over() && runner.screen().key == key && !runner.may_go_on()) runner.pass(1);
        std::vector<HapticSample> ticks(300);
        for (std::size_t t = 0; t < ticks.size(); ++t)
          ticks[t] = {static_cast<std::int64_t>(1000 * t), Vec3::Zero(), Vec3(0, 0, 1.5), true, 1};
        if (runner.screen().key != key) continue;
        runner.add_samples(ticks);
      }
      runner.answer(person.answer(runner.screen()));
    }
  }
}

int palpate(const std::string& words) {
  const int status = std::system((std::string(PALPATE_PROGRAM) + " " + words + " 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

class StudyAnalyse : public testing::Test {
 protected:
  fs::path folder_ =
      fs::path(testing::TempDir()) / ("palpate_study_analyse_" + std::to_string(getpid()));
  fs::path file_ = folder_ / "study.db", results_ = folder_ / "results";
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] int analyse() const {
    return palpate("study analyse " + file_.string() + " --quiet -o " + results_.string());
  }
};

TEST_F(StudyAnalyse, PublishedProtocolGivesReportTablesFiguresAndBids) {
  make_study(file_, "head-stiffness-2015.toml", 8);
  ASSERT_EQ(analyse(), 0);
  const std::string report = read_file(results_ / "report.html");
  EXPECT_NE(report.find("SIMULATED DATA"), std::string::npos);
  EXPECT_NE(report.find("&lt;head&gt; &amp; co.glb"), std::string::npos);
  for (const char* section :
       {"ratings", "groups", "sight", "order", "rationality", "felt", "touch"})
    EXPECT_NE(report.find("<section id=\"" + std::string(section)), std::string::npos) << section;
  EXPECT_EQ(report.find("<script"), std::string::npos);
  EXPECT_EQ(report.find("http://"), report.find("http://www.w3.org/2000/svg"));
  for (const char* file :
       {"figures/ratings.svg", "figures/touch-and-sight.svg", "tables/trials.csv",
        "tables/tests.csv", "bids/dataset_description.json", "bids/participants.tsv"})
    EXPECT_TRUE(fs::is_regular_file(results_ / file)) << file;
  for (const auto& figure : fs::directory_iterator(results_ / "figures"))
    EXPECT_NE(read_file(figure.path()).find("simulated participants"), std::string::npos)
        << figure.path();
  const auto summary = nlohmann::json::parse(read_file(results_ / "analysis.json"));
  EXPECT_EQ(summary["participants"], 8);
  EXPECT_TRUE(summary["simulated"].get<bool>());
  // Weber's law and a clear order: what is felt follows the map.
  EXPECT_GT(summary["felt_spearman"]["touch"].get<double>(), 0.8);
  EXPECT_FALSE(fs::exists(results_.string() + ".new"));
}

TEST_F(StudyAnalyse, WhoWithdrewIsGoneFromTheResultsToo) {
  make_study(file_, "head-stiffness-2015.toml", 3);
  ASSERT_EQ(analyse(), 0);
  const std::string first = Store::open(file_, Store::Access::read).participants()[0].pseudonym;
  ASSERT_TRUE(fs::exists(results_ / "bids" / ("sub-" + first)));
  Store::open(file_, Store::Access::run, Store::Durability::process).withdraw(first);
  ASSERT_EQ(analyse(), 0);
  EXPECT_FALSE(fs::exists(results_ / "bids" / ("sub-" + first)));
  EXPECT_EQ(read_file(results_ / "tables/trials.csv").find(first), std::string::npos);
}

TEST_F(StudyAnalyse, DiscriminationGivesWeberFractions) {
  make_study(file_, "stiffness-discrimination.toml", 4);
  ASSERT_EQ(analyse(), 0);
  const auto summary = nlohmann::json::parse(read_file(results_ / "analysis.json"));
  const double w = summary["weber_fraction"]["geometric_mean"].get<double>();
  EXPECT_GT(w, 0.15 / 2);
  EXPECT_LT(w, 0.15 * 2);
  EXPECT_TRUE(fs::exists(results_ / "figures/discrimination.svg"));
}

TEST_F(StudyAnalyse, AnotherFolderIsNotReplacedAndBadFilesAreRefused) {
  make_study(file_, "head-stiffness-2015.toml", 1);
  fs::create_directories(results_);
  write_file(results_ / "mine.txt", "mine");
  EXPECT_EQ(analyse(), 2);
  EXPECT_EQ(read_file(results_ / "mine.txt"), "mine");
  fs::remove(results_ / "mine.txt");
  EXPECT_EQ(analyse(), 0);  // one participant: described, nothing tested
  write_file(file_, "SQLite format 3 is not what follows");
  EXPECT_EQ(analyse(), 2);
  EXPECT_TRUE(fs::exists(results_ / "report.html"));  // the earlier results stay
  EXPECT_EQ(palpate("study analyse " + (folder_ / "none.db").string() + " -o " + results_.string()),
            2);
}

}  // namespace
}  // namespace palpate::study
