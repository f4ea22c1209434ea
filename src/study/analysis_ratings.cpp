// SPDX-License-Identifier: GPL-3.0-or-later
// Ratings per region: described, between groups, and the same people under both conditions.
#include <algorithm>
#include <cmath>

#include "study/analysis_parts.hpp"
#include "study/statistics/effect_sizes.hpp"
#include "study/statistics/multiple_testing.hpp"

namespace palpate::study {
namespace {

/// A question with more answers than this is not a grouping (free numbers, fields of study).
constexpr std::size_t kMostLevels = 6;
/// Fewer people than this have no spread to compare.
constexpr std::size_t kLeastPerGroup = 2;

Condition condition(const Scene& scene, std::string id, std::string title,
                    const RatingTable& table) {
  Condition out{std::move(id), std::move(title), {}};
  for (std::size_t r = 0; r < scene.regions.size(); ++r)
    out.regions.push_back(described(column(table, r)));
  return out;
}

/// Values of the people whose answer is `level`; the others are left out.
std::vector<double> of_level(const std::vector<double>& values,
                             const std::vector<std::string>& answer, const std::string& level) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (answer[i] == level) out.push_back(values[i]);
  return out;
}

GroupTest group_test(std::string quantity, std::vector<double> a, std::vector<double> b) {
  GroupTest out;
  out.quantity = std::move(quantity);
  out.a = described(std::move(a));
  out.b = described(std::move(b));
  out.welch = st::welch_t(out.a.moments, out.b.moments);
  out.mann_whitney = st::mann_whitney(out.a.value, out.b.value);
  out.hedges_g = st::hedges_g(out.a.moments, out.b.moments);
  out.normal_a = st::shapiro_wilk(out.a.value);
  out.normal_b = st::shapiro_wilk(out.b.value);
  out.spread = st::brown_forsythe(out.a.value, out.b.value);
  return out;
}

/// Holm over the first `regions` tests; what follows (rationality) is a question of its own.
void adjust(std::vector<GroupTest>& tests, std::size_t regions) {
  std::vector<double> welch, ranks;
  for (std::size_t i = 0; i < regions; ++i) {
    welch.push_back(tests[i].welch.p);
    ranks.push_back(tests[i].mann_whitney.p);
  }
  welch = st::holm(welch);
  ranks = st::holm(ranks);
  for (std::size_t i = 0; i < regions; ++i) {
    tests[i].welch_holm = welch[i];
    tests[i].mann_whitney_holm = ranks[i];
  }
}

/// Answers given, the most frequent first, equal counts by name.
std::vector<std::pair<std::string, std::size_t>> levels_of(const std::vector<std::string>& answer) {
  std::map<std::string, std::size_t> count;
  for (const std::string& a : answer)
    if (!a.empty()) ++count[a];
  std::vector<std::pair<std::string, std::size_t>> out(count.begin(), count.end());
  std::stable_sort(out.begin(), out.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return out;
}

/// Nothing where fewer than two answers were given, or too many to be groups.
std::optional<Grouping> grouping(const Scene& scene, const RatingTable& both,
                                 const Question& question, bool planned) {
  std::vector<std::string> answer;
  for (const Participant* p : scene.people) {
    const auto at = p->background.find(question.id);
    answer.push_back(at == p->background.end() ? "" : at->second);
  }
  const auto levels = levels_of(answer);
  if (levels.size() < 2 || levels.size() > kMostLevels) return std::nullopt;
  Grouping out;
  out.question = question.id;
  out.title = question.text;
  out.planned = planned;
  for (const auto& [level, size] : levels) {
    out.levels.push_back(level);
    out.sizes.push_back(size);
    out.by_level.emplace_back();
    for (std::size_t r = 0; r < scene.regions.size(); ++r)
      out.by_level.back().push_back(described(of_level(column(both, r), answer, level)));
  }
  if (levels[1].second < kLeastPerGroup) return out;
  for (std::size_t r = 0; r < scene.regions.size(); ++r)
    out.tests.push_back(
        group_test(scene.regions[r], out.by_level[0][r].value, out.by_level[1][r].value));
  adjust(out.tests, out.tests.size());
  if (scene.rationality)
    out.tests.push_back(group_test("rationality",
                                   of_level(*scene.rationality, answer, levels[0].first),
                                   of_level(*scene.rationality, answer, levels[1].first)));
  return out;
}

}  // namespace

RatingTable mean_of(const std::vector<Experiment>& experiments) {
  if (experiments.empty()) return {};
  RatingTable out = experiments.front().rating;
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t r = 0; r < out[i].size(); ++r) {
      std::vector<double> given;
      for (const Experiment& e : experiments) given.push_back(e.rating[i][r]);
      out[i][r] = on_scale(st::moments(given).mean);
    }
  return out;
}

std::vector<Condition> conditions(const Scene& scene) {
  std::vector<Condition> out;
  for (const Experiment& e : scene.experiments)
    out.push_back(condition(scene, e.part->id, e.part->title, e.rating));
  if (scene.experiments.size() > 1)
    out.push_back(
        condition(scene, "both", "Mean of each person's ratings", mean_of(scene.experiments)));
  return out;
}

std::vector<Grouping> groupings(const Scene& scene) {
  std::vector<Grouping> out;
  if (scene.experiments.empty()) return out;
  const RatingTable both = mean_of(scene.experiments);
  for (const Part& part : scene.data.protocol.parts) {
    if (part.kind != PartKind::questions) continue;
    for (const Question& q : part.questions) {
      const bool planned = part.id + "/" + q.id == scene.data.protocol.analysis.group;
      if (q.type != QuestionType::choice) continue;
      if (auto g = grouping(scene, both, q, planned)) out.push_back(std::move(*g));
    }
  }
  std::stable_partition(out.begin(), out.end(), [](const Grouping& g) { return g.planned; });
  return out;
}

std::vector<PairedTest> paired_tests(const Scene& scene) {
  const auto& plan = scene.data.protocol.analysis;
  const Experiment* touch = scene.experiment(plan.touch_only);
  const Experiment* sight = scene.experiment(plan.touch_and_sight);
  std::vector<PairedTest> out;
  if (!touch || !sight) return out;
  std::vector<double> t_p, w_p;
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    PairedTest test;
    test.region = scene.regions[r];
    test.touch = column(touch->rating, r);
    test.sight = column(sight->rating, r);
    const std::vector<double> d = on_scale(st::differences(test.sight, test.touch));
    test.t = st::one_sample_t(st::moments(d), 0);
    test.wilcoxon = st::wilcoxon_signed_rank(d);
    test.d_z = st::standardised_mean(st::moments(d));
    test.normal = st::shapiro_wilk(d);
    t_p.push_back(test.t.p);
    w_p.push_back(test.wilcoxon.p);
    out.push_back(std::move(test));
  }
  t_p = st::holm(t_p);
  w_p = st::holm(w_p);
  for (std::size_t r = 0; r < out.size(); ++r) {
    out[r].t_holm = t_p[r];
    out[r].wilcoxon_holm = w_p[r];
  }
  return out;
}

}  // namespace palpate::study
