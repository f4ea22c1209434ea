// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/study_report_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/study_words.hpp"

namespace palpate::app {
namespace {

using namespace study;
namespace st = study::statistics;
using report::Page;
using Row = std::vector<std::string>;

constexpr double kLevel = 0.05;  ///< below it a p is pointed out in tables

std::string mean_sd(const Described& d) {
  return d.moments.n == 0
             ? "–"
             : fmt::format("{} ({})", fixed(d.moments.mean, 2), fixed(d.moments.sd, 2));
}

std::string percent(const st::Proportion& p) {
  return p.trials == 0
             ? "–"
             : fmt::format("{} % ({}/{})", fixed(100 * p.share, 0), p.successes, p.trials);
}
std::string percent_interval(const st::Interval& i) {
  return interval_cell({100 * i.low, 100 * i.high}, 0) + " %";
}

/// Short name of a form, for a column.
std::string form_cell(st::RankForm form) {
  return form == st::RankForm::exact ? "exact" : form == st::RankForm::normal ? "normal" : "–";
}

void add_group_tests(Page& page, const Grouping& g) {
  if (g.tests.empty()) {
    page.paragraph("An answer that only one person gave has no spread: no test.");
    return;
  }
  if (g.levels.size() > 2)
    page.paragraph(fmt::format("The two most frequent answers are compared: {} and {}.",
                               g.levels[0], g.levels[1]));
  Page::Table table;
  table.head = {"",  "difference", "95 % interval", "Welch t (df)", "p", "Holm", "Mann–Whitney U",
                "p", "Holm",       "form",          "Hedges g"};
  for (std::size_t i = 0; i < g.tests.size(); ++i) {
    const GroupTest& t = g.tests[i];
    table.rows.push_back(
        {t.quantity, fixed(t.welch.difference, 2), interval_cell(t.welch.interval, 2),
         fmt::format("{} ({})", fixed(t.welch.t, 2), fixed(t.welch.df, 1)), p_cell(t.welch.p),
         p_cell(t.welch_holm), fixed(t.mann_whitney.u, 1), p_cell(t.mann_whitney.p),
         p_cell(t.mann_whitney_holm), form_cell(t.mann_whitney.form), fixed(t.hedges_g, 2)});
    if (std::fmin(t.welch_holm, t.mann_whitney_holm) < kLevel) table.marked.push_back(i);
  }
  page.table(table);
  page.begin_details("Assumptions of the t test");
  Page::Table checks;
  checks.head = {"",
                 "Shapiro–Wilk W, first group",
                 "p",
                 "W, second group",
                 "p",
                 "ratio of variances",
                 "Brown–Forsythe p"};
  for (const GroupTest& t : g.tests)
    checks.rows.push_back({t.quantity, fixed(t.normal_a.w, 3), p_cell(t.normal_a.p),
                           fixed(t.normal_b.w, 3), p_cell(t.normal_b.p), fixed(t.spread.ratio, 2),
                           p_cell(t.spread.p)});
  page.table(checks);
  page.paragraph(
      "Welch's test does not need equal variances. Where normality is doubtful, Mann–Whitney is "
      "the safer one.");
  page.end_details();
}

}  // namespace

void add_ratings(Page& page, const Results& r, Figures& figures) {
  if (r.conditions.empty()) return;
  page.section("ratings", "How stiff each place felt");
  page.paragraph(
      "Mean (standard deviation) of the ratings, and the 95 % interval of the mean by Student's "
      "t.");
  Page::Table table;
  table.head = {"place"};
  for (const Condition& c : r.conditions) {
    table.head.push_back(c.title);
    table.head.emplace_back("95 % interval");
    table.head.emplace_back("median");
    table.head.emplace_back("n");
  }
  for (std::size_t k = 0; k < r.regions.size(); ++k) {
    Row row = {r.regions[k]};
    for (const Condition& c : r.conditions) {
      const Described& d = c.regions[k];
      row.insert(row.end(), {mean_sd(d), interval_cell(d.interval, 2), fixed(d.median, 1),
                             std::to_string(d.moments.n)});
    }
    table.rows.push_back(std::move(row));
  }
  page.table(table);
  figures.add("ratings");
  for (const Condition& c : r.conditions) figures.add("ratings-" + c.id);
}

void add_groups(Page& page, const Results& r, Figures& figures) {
  if (r.groupings.empty()) return;
  page.section("groups", "Groups");
  page.paragraph(
      "Each person's mean over the experiments. The protocol's own grouping comes first; the "
      "others are exploratory: they were not planned and their p are not adjusted for one "
      "another.");
  for (const Grouping& g : r.groupings) {
    if (g.planned)
      page.subsection(spaced(g.question));
    else
      page.begin_details("Exploratory: " + spaced(g.question));
    Page::Table table;
    table.head = {"place"};
    for (std::size_t l = 0; l < g.levels.size(); ++l)
      table.head.push_back(fmt::format("{} (n = {})", g.levels[l], g.sizes[l]));
    for (std::size_t k = 0; k < r.regions.size(); ++k) {
      Row row = {r.regions[k]};
      for (const auto& level : g.by_level) row.push_back(mean_sd(level[k]));
      table.rows.push_back(std::move(row));
    }
    page.table(table);
    add_group_tests(page, g);
    figures.add("groups-" + g.question);
    if (!g.planned) page.end_details();
  }
}

void add_paired(Page& page, const Results& r, Figures& figures) {
  if (r.paired.empty()) return;
  page.section("sight", "Does seeing change what is felt?");
  page.paragraph(
      "The same people rated each place by touch only and by touch and sight; differences are "
      "sight − touch. Both tests are two-sided and adjusted by Holm over the places.");
  Page::Table table;
  table.head = {"place",        "difference", "95 % interval", "paired t (df)", "p",    "Holm",
                "Wilcoxon W",   "p",          "Holm",          "zeros dropped", "form", "d_z",
                "rank-biserial"};
  for (std::size_t i = 0; i < r.paired.size(); ++i) {
    const PairedTest& t = r.paired[i];
    table.rows.push_back(
        {t.region, fixed(t.t.difference, 2), interval_cell(t.t.interval, 2),
         fmt::format("{} ({})", fixed(t.t.t, 2), fixed(t.t.df, 0)), p_cell(t.t.p), p_cell(t.t_holm),
         fixed(std::min(t.wilcoxon.w_plus, t.wilcoxon.w_minus), 1), p_cell(t.wilcoxon.p),
         p_cell(t.wilcoxon_holm), std::to_string(t.wilcoxon.zeros), form_cell(t.wilcoxon.form),
         fixed(t.d_z, 2), fixed(t.wilcoxon.rank_biserial, 2)});
    if (std::fmin(t.t_holm, t.wilcoxon_holm) < kLevel) table.marked.push_back(i);
  }
  page.table(table);
  page.begin_details("Assumption of the paired t test: normal differences");
  Page::Table checks;
  checks.head = {"place", "Shapiro–Wilk W", "p"};
  for (const PairedTest& t : r.paired)
    checks.rows.push_back({t.region, fixed(t.normal.w, 3), p_cell(t.normal.p)});
  page.table(checks);
  page.end_details();
  figures.add("touch-and-sight");
}

void add_order(Page& page, const StudyData& data, const Results& r, Figures& figures) {
  if (r.selections.empty() && r.rankings.empty()) return;
  page.section("order", "Is the order right?");
  std::string order;
  for (const std::string& region : data.protocol.analysis.reference_order)
    order += (order.empty() ? "" : ", ") + region;
  page.paragraph("Reference order, stiff to soft: " + order + ".");
  if (!r.selections.empty()) {
    Page::Table table;
    table.head = {"experiment",           "chosen as",
                  "right of all choices", "Wilson 95 %",
                  "Clopper–Pearson 95 %", "people with all right",
                  "Wilson 95 %"};
    table.text_columns = 2;
    for (const Selection& s : r.selections)
      table.rows.push_back({s.title, s.toughest ? "toughest" : "softest", percent(s.choices),
                            percent_interval(s.choices.wilson),
                            percent_interval(s.choices.clopper_pearson), percent(s.people),
                            percent_interval(s.people.wilson)});
    page.table(table);
    page.paragraph(
        "The share of all choices is the published measure; one person's choices are not "
        "independent, so its interval is somewhat too narrow. The share of people is free of "
        "that.");
    figures.add("toughest");
    figures.add("softest");
  }
  if (r.rankings.empty()) return;
  page.subsection("Ranking of the ratings");
  Page::Table table;
  table.head = {"experiment",
                "pairs right, mean",
                "95 % interval",
                "all pairs right",
                "Kendall tau-b, mean (SD)",
                "tau-b of the mean ratings",
                "p",
                "form"};
  for (const Ranking& k : r.rankings)
    table.rows.push_back({k.title, fixed(100 * k.accuracy.moments.mean, 2) + " %",
                          percent_interval(k.accuracy.interval),
                          fmt::format("{} of {}", k.perfect, k.accuracy.moments.n),
                          fmt::format("{} ({})", fixed(k.tau.mean, 3), fixed(k.tau.sd, 3)),
                          fixed(k.of_means.tau_b, 3), p_cell(k.of_means.p),
                          form_cell(k.of_means.form)});
  page.table(table);
  page.paragraph(
      "Pairs right is the published measure: a pair rated equal counts as right. Tau-b takes ties "
      "into account.");
  figures.add("ranking");
}

void add_rationality(Page& page, const Results& r, Figures& figures) {
  for (const Rationality& one : r.rationality) {
    page.section("rationality", "Does the head make sense as a whole?");
    page.facts(
        {{"ratings",
          fmt::format("mean {} (SD {}), median {}, n = {}", fixed(one.ratings.moments.mean, 3),
                      fixed(one.ratings.moments.sd, 3), fixed(one.ratings.median, 1),
                      one.ratings.moments.n)},
         {fmt::format("one-sample t against {}", one.reference),
          fmt::format("t({}) = {}, {}, two-sided; difference {} (95 % {})", fixed(one.t.df, 0),
                      fixed(one.t.t, 3),
                      std::isnan(one.t.p) ? "no test" : fmt::format("p = {:.4f}", one.t.p),
                      fixed(one.t.difference, 2), interval_cell(one.t.interval, 2))},
         {"effect size d", fixed(one.d, 2)},
         {"Wilcoxon signed rank",
          fmt::format("W = {}, {}; {} zero differences dropped; {}",
                      fixed(std::min(one.wilcoxon.w_plus, one.wilcoxon.w_minus), 1),
                      p_words(one.wilcoxon.p), one.wilcoxon.zeros, st::words(one.wilcoxon.form))},
         {"normality (Shapiro–Wilk)",
          fmt::format("W = {}, {}", fixed(one.normal.w, 3), p_words(one.normal.p))}});
    figures.add("rationality");
  }
}

void add_felt(Page& page, const Results& r, Figures& figures) {
  if (r.felt.empty()) return;
  page.section("felt", "Felt against the map");
  page.paragraph(
      "Mean ratings with the stiffness that the head has at the touched points (2 N divided by the "
      "travel at 2 N). People judge ratios, so the straight line is fitted to the logarithm.");
  Page::Table table;
  table.head = {"experiment",
                "Spearman",
                "p",
                "Pearson",
                "p",
                "Pearson, log",
                "p",
                "each person's Spearman, median",
                "against 0: Wilcoxon p",
                "form"};
  for (const FeltAgainstMap& f : r.felt)
    table.rows.push_back({f.title, fixed(f.spearman.r, 3), p_cell(f.spearman.p),
                          fixed(f.pearson.r, 3), p_cell(f.pearson.p), fixed(f.pearson_log.r, 3),
                          p_cell(f.pearson_log.p), fixed(f.median_rho, 3),
                          p_cell(f.rho_against_zero.p), form_cell(f.rho_against_zero.form)});
  page.table(table);
  for (const FeltAgainstMap& f : r.felt) figures.add("felt-" + f.experiment);
}

void add_discrimination(Page& page, const Results& r, Figures& figures) {
  const Discrimination& d = r.discrimination;
  if (d.rows.empty()) return;
  page.section("discrimination", "How small a difference can be felt");
  page.paragraph(
      fmt::format("Weber fraction: the relative difference at which 75 % of the choices are right, "
                  "by maximum likelihood (cumulative normal, proportional to the difference, {} % "
                  "lapses); interval by the likelihood ratio. Geometric mean over people: {} (95 % "
                  "{}, Student's t of the logarithms).",
                  fixed(100 * st::PsychometricOptions{}.lapse, 0), fixed(d.geometric_mean, 3),
                  interval_cell(d.interval, 3)));
  if (d.unbounded > 0)
    page.paragraph(
        fmt::format("{} of {} runs do not bound a Weber fraction (all right, or no better than "
                    "guessing); they are left out of the mean.",
                    d.unbounded, d.rows.size()));
  figures.add("discrimination");
  figures.add("weber");
  page.begin_details("Each run");
  Page::Table table;
  table.head = {"participant",    "experiment",    "place", "trials",      "right",
                "Weber fraction", "95 % interval", "shape", "p of shape 1"};
  table.text_columns = 3;
  for (const WeberRow& w : d.rows)
    table.rows.push_back({w.pseudonym, w.experiment, w.region, std::to_string(w.fit.trials),
                          std::to_string(w.fit.correct), fixed(w.fit.weber_fraction, 3),
                          std::isinf(w.fit.interval.high) ? "from " + fixed(w.fit.interval.low, 3)
                                                          : interval_cell(w.fit.interval, 3),
                          fixed(w.fit.shape, 2), p_cell(w.fit.shape_p)});
  page.table(table);
  page.end_details();
}

}  // namespace palpate::app
