// SPDX-License-Identifier: GPL-3.0-or-later
// RFC 4180, Common Format and MIME Type for CSV Files. Tidy: Wickham 2014, "Tidy data".
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "study/export.hpp"
#include "study/table_text.hpp"

namespace palpate::study {
namespace {

std::string yes_no(bool b) {
  return b ? "yes" : "no";
}

struct People {
  std::map<std::string, const Participant*> by_name;
  explicit People(const StudyData& data) {
    for (const Participant& p : data.participants) by_name[p.pseudonym] = &p;
  }
  /// participant, state, simulated, group
  [[nodiscard]] std::vector<std::string> cells(const std::string& pseudonym) const {
    const auto at = by_name.find(pseudonym);
    if (at == by_name.end()) return {pseudonym, "", "", ""};
    const Participant& p = *at->second;
    return {pseudonym, std::string(name(p.state)), yes_no(p.simulated), p.group};
  }
};

std::vector<std::string> joined(std::vector<std::string> cells, std::vector<std::string> more) {
  cells.insert(cells.end(), more.begin(), more.end());
  return cells;
}

std::string trials_table(const StudyData& data, const People& people) {
  std::map<std::string, const StudyRegion*> regions;
  for (const StudyRegion& r : data.study.regions) regions[r.name] = &r;
  CsvText out{"participant",  "state",          "simulated",
              "group",        "experiment",     "trial",
              "region",       "interval",       "stiffness_factor",
              "head_visible", "rating",         "description",
              "started_utc",  "duration_s",     "contact_s",
              "peak_force_n", "haptic_samples", "map_stiffness_n_per_mm"};
  for (std::size_t i = 0; i < data.trials.size(); ++i) {
    const TrialRecord& t = data.trials[i];
    const TrialTouch& touch = data.touch[i];
    const double seconds = t.ended ? 1e-3 * static_cast<double>(t.ended - t.started) : kNothing;
    const auto r = regions.find(t.region);
    out.row(
        joined(people.cells(t.pseudonym),
               {t.experiment, std::to_string(t.index), t.region,
                t.interval ? std::to_string(t.interval) : "", number_cell(t.factor),
                yes_no(t.head_visible), number_cell(t.rating), t.description, utc_text(t.started),
                number_cell(seconds), touch.samples ? number_cell(touch.contact_s) : "",
                number_cell(touch.peak_force), std::to_string(touch.samples),
                number_cell(r == regions.end() ? kNothing : r->second->stiffness_at_point)}));
  }
  return std::move(out).text();
}

std::string selections_table(const StudyData& data, const People& people) {
  CsvText out{"participant", "state", "simulated", "group", "experiment", "chosen_as", "region"};
  for (const Choice& c : data.choices)
    for (const auto& [as, list] :
         {std::pair{"toughest", &c.toughest}, std::pair{"softest", &c.softest}})
      for (const std::string& region : *list)
        out.row(joined(people.cells(c.pseudonym), {c.experiment, as, region}));
  return std::move(out).text();
}

std::string comparisons_table(const StudyData& data, const People& people) {
  CsvText out{"participant",
              "state",
              "simulated",
              "group",
              "experiment",
              "region",
              "trial",
              "relative_difference",
              "stiffer_interval",
              "answered_interval",
              "correct"};
  for (const Comparison& c : data.comparisons)
    out.row(joined(people.cells(c.pseudonym),
                   {c.experiment, c.region, std::to_string(c.index), number_cell(c.difference),
                    std::to_string(c.stiffer), std::to_string(c.answered), yes_no(c.correct())}));
  return std::move(out).text();
}

std::string answers_table(const StudyData& data, const People& people) {
  CsvText out{"participant", "state", "simulated", "group",
              "screen",      "value", "asked_utc", "answered_utc"};
  for (const Answer& a : data.answers)
    out.row(joined(people.cells(a.pseudonym),
                   {a.key, a.value, utc_text(a.asked), utc_text(a.answered)}));
  return std::move(out).text();
}

std::string participants_table(const StudyData& data, const People& people) {
  CsvText out{"participant", "state",        "simulated", "group",
              "order_index", "enrolled_utc", "ended_utc"};
  for (const Participant& p : data.participants)
    out.row(joined(people.cells(p.pseudonym),
                   {std::to_string(p.order_index), utc_text(p.enrolled), utc_text(p.ended)}));
  return std::move(out).text();
}

/// Rows of tests.csv.
class Tests {
 public:
  explicit Tests(bool simulated) : simulated_(simulated) {}
  void add(const std::string& question, const std::string& quantity, const std::string& test,
           double statistic, double df, double p, double p_holm, double estimate,
           const st::Interval& i, const std::string& effect_name, double effect,
           const std::string& n, const std::string& form = "") {
    out_.row({question, quantity, test, form, number_cell(statistic), number_cell(df),
              number_cell(p), number_cell(p_holm), number_cell(estimate), number_cell(i.low),
              number_cell(i.high), effect_name, number_cell(effect), n, yes_no(simulated_)});
  }
  void add_rank(const std::string& question, const std::string& quantity, const std::string& test,
                double statistic, double p, double p_holm, double effect, const std::string& n,
                st::RankForm form) {
    add(question, quantity, test, statistic, kNothing, p, p_holm, kNothing, {kNothing, kNothing},
        "rank-biserial", effect, n, std::string(st::words(form)));
  }
  [[nodiscard]] std::string text() && { return std::move(out_).text(); }

 private:
  CsvText out_{"question", "quantity",    "test",   "form",     "statistic",
               "df",       "p",           "p_holm", "estimate", "low_95",
               "high_95",  "effect_name", "effect", "n",        "simulated"};
  bool simulated_;
};

std::string size_of(const Described& d) {
  return std::to_string(d.moments.n);
}

void add_groups(Tests& out, const Results& results) {
  for (const Grouping& g : results.groupings)
    for (const GroupTest& t : g.tests) {
      const std::string question =
          fmt::format("{}: {} against {}", g.question, g.levels[0], g.levels[1]);
      const std::string n = size_of(t.a) + "+" + size_of(t.b);
      out.add(question, t.quantity, "Welch t", t.welch.t, t.welch.df, t.welch.p, t.welch_holm,
              t.welch.difference, t.welch.interval, "Hedges g", t.hedges_g, n);
      out.add_rank(question, t.quantity, "Mann-Whitney U", t.mann_whitney.u, t.mann_whitney.p,
                   t.mann_whitney_holm, t.mann_whitney.rank_biserial, n, t.mann_whitney.form);
      out.add(question, t.quantity, "Brown-Forsythe", t.spread.f, kNothing, t.spread.p, kNothing,
              t.spread.ratio, {kNothing, kNothing}, "", kNothing, n);
    }
}

void add_paired(Tests& out, const Results& results) {
  for (const PairedTest& t : results.paired) {
    const std::string n = std::to_string(st::numbers(st::differences(t.sight, t.touch)).size());
    const std::string question = "touch and sight against touch only";
    out.add(question, t.region, "paired t", t.t.t, t.t.df, t.t.p, t.t_holm, t.t.difference,
            t.t.interval, "d_z", t.d_z, n);
    out.add_rank(question, t.region, "Wilcoxon signed rank (zeros dropped)",
                 std::min(t.wilcoxon.w_plus, t.wilcoxon.w_minus), t.wilcoxon.p, t.wilcoxon_holm,
                 t.wilcoxon.rank_biserial, n, t.wilcoxon.form);
  }
}

void add_rest(Tests& out, const Results& results) {
  for (const Rationality& r : results.rationality) {
    const std::string question = fmt::format("rationality against {}", r.reference);
    out.add(question, "rationality", "one-sample t", r.t.t, r.t.df, r.t.p, kNothing, r.t.difference,
            r.t.interval, "d", r.d, size_of(r.ratings));
    out.add_rank(question, "rationality", "Wilcoxon signed rank (zeros dropped)",
                 std::min(r.wilcoxon.w_plus, r.wilcoxon.w_minus), r.wilcoxon.p, kNothing,
                 r.wilcoxon.rank_biserial, size_of(r.ratings), r.wilcoxon.form);
  }
  for (const Selection& s : results.selections) {
    const std::string question =
        fmt::format("{}: {} rightly chosen", s.experiment, s.toughest ? "toughest" : "softest");
    for (const auto& [what, p] :
         {std::pair{"choices", &s.choices}, std::pair{"people", &s.people}}) {
      const std::string n = fmt::format("{}/{}", p->successes, p->trials);
      out.add(question, what, "Wilson interval", kNothing, kNothing, kNothing, kNothing, p->share,
              p->wilson, "", kNothing, n);
      out.add(question, what, "Clopper-Pearson interval", kNothing, kNothing, kNothing, kNothing,
              p->share, p->clopper_pearson, "", kNothing, n);
    }
  }
  for (const Ranking& r : results.rankings)
    out.add(r.experiment + ": ranking", "pair accuracy", "mean", kNothing, kNothing, kNothing,
            kNothing, r.accuracy.moments.mean, r.accuracy.interval, "mean tau-b", r.tau.mean,
            size_of(r.accuracy));
  for (const FeltAgainstMap& f : results.felt)
    for (const auto& [what, c] :
         {std::pair{"Pearson", &f.pearson}, std::pair{"Pearson, log stiffness", &f.pearson_log},
          std::pair{"Spearman", &f.spearman}})
      out.add(f.experiment + ": mean rating with map stiffness", "regions", what, kNothing,
              static_cast<double>(c->n) - 2, c->p, kNothing, c->r, c->interval, "", kNothing,
              std::to_string(c->n));
  for (const WeberRow& w : results.discrimination.rows)
    out.add(w.experiment + ": Weber fraction", w.region + " " + w.pseudonym, "maximum likelihood",
            kNothing, kNothing, kNothing, kNothing, w.fit.weber_fraction, w.fit.interval, "",
            kNothing, std::to_string(w.fit.trials));
}

}  // namespace

std::vector<ExportFile> tidy_tables(const StudyData& data, const Results& results) {
  const People people(data);
  Tests tests(data.study.simulated);
  add_groups(tests, results);
  add_paired(tests, results);
  add_rest(tests, results);
  return {{"tables/trials.csv", trials_table(data, people)},
          {"tables/selections.csv", selections_table(data, people)},
          {"tables/comparisons.csv", comparisons_table(data, people)},
          {"tables/answers.csv", answers_table(data, people)},
          {"tables/participants.csv", participants_table(data, people)},
          {"tables/tests.csv", std::move(tests).text()}};
}

}  // namespace palpate::study
