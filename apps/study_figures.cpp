// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of a study; which and why: docs/method/statistics.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/study_analyse.hpp"
#include "apps/study_words.hpp"
#include "plot/comparisons.hpp"

namespace palpate::app {
namespace {

using namespace study;
namespace st = study::statistics;

plot::Column column(const Described& d) {
  return {d.moments.mean, d.interval.low, d.interval.high};
}
plot::Column column(const st::Proportion& p) {
  return {100 * p.share, 100 * p.wilson.low, 100 * p.wilson.high};
}

StudyFigure ratings_by_condition(const Results& r, const std::string& mark) {
  plot::ColumnChart chart;
  chart.title = "Ratings of stiffness" + mark;
  chart.y_label = "mean rating, 95 % interval";
  for (const Condition& c : r.conditions)
    if (c.id != "both") chart.series.push_back({c.title, ""});
  for (std::size_t k = 0; k < r.regions.size(); ++k) {
    plot::ColumnGroup group{r.regions[k], {}, ""};
    for (const Condition& c : r.conditions)
      if (c.id != "both") group.columns.push_back(column(c.regions[k]));
    chart.groups.push_back(std::move(group));
  }
  return {"ratings", svg(chart), "Mean rating of each place; bars are 95 % intervals of the mean."};
}

StudyFigure ratings_spread(const Condition& c, const Results& r, const std::string& mark) {
  plot::StripPlot strips;
  strips.title = "Every rating: " + c.title + mark;
  strips.y_label = "rating";
  for (std::size_t k = 0; k < r.regions.size(); ++k)
    strips.strips.push_back({r.regions[k], c.regions[k].value, ""});
  return {
      "ratings-" + c.id, svg(strips),
      "Each dot is one person. Boxes: quartiles and median; whiskers: to the farthest value within "
      "1.5 box heights."};
}

StudyFigure groups(const Grouping& g, const Results& r, const std::string& mark) {
  plot::ColumnChart chart;
  chart.title = "Ratings by group: " + spaced(g.question) + mark;
  chart.y_label = "mean rating, 95 % interval";
  for (std::size_t l = 0; l < g.levels.size(); ++l)
    chart.series.push_back({fmt::format("{} (n = {})", g.levels[l], g.sizes[l]), ""});
  for (std::size_t k = 0; k < r.regions.size(); ++k) {
    plot::ColumnGroup group{r.regions[k], {}, ""};
    for (const auto& level : g.by_level) group.columns.push_back(column(level[k]));
    chart.groups.push_back(std::move(group));
  }
  return {"groups-" + g.question, svg(chart),
          "Mean of each person's ratings in all experiments, by group."};
}

StudyFigure pairs(const Results& r, const std::string& mark) {
  plot::SlopePlot slopes;
  slopes.title = "Touch only against touch and sight" + mark;
  slopes.y_label = "rating";
  slopes.left_name = "touch";
  slopes.right_name = "+ sight";
  for (const PairedTest& t : r.paired) {
    plot::SlopePanel panel{t.region, {}, p_words(t.t_holm)};
    for (std::size_t i = 0; i < t.touch.size(); ++i)
      panel.pairs.push_back({t.touch[i], t.sight[i]});
    slopes.panels.push_back(std::move(panel));
  }
  return {"touch-and-sight", svg(slopes),
          "Each thin line is one person, the thick line the mean. p: paired t, adjusted by Holm."};
}

StudyFigure selection(const Results& r, bool toughest, const std::string& mark) {
  plot::ColumnChart chart;
  chart.title = std::string(toughest ? "Chosen as toughest" : "Chosen as softest") + mark;
  chart.y_label = "people [%], 95 % interval";
  std::vector<const Selection*> shown;
  for (const Selection& s : r.selections)
    if (s.toughest == toughest) shown.push_back(&s);
  for (const Selection* s : shown) chart.series.push_back({s->title, ""});
  for (std::size_t k = 0; k < r.regions.size(); ++k) {
    plot::ColumnGroup group{r.regions[k], {}, ""};
    for (const Selection* s : shown) {
      group.columns.push_back(column(s->regions[k]));
      if (std::find(s->right.begin(), s->right.end(), r.regions[k]) != s->right.end())
        group.mark = "expected";
    }
    chart.groups.push_back(std::move(group));
  }
  return {toughest ? "toughest" : "softest", svg(chart),
          "Share of people who chose each place; intervals after Wilson. \"expected\": by the "
          "reference order."};
}

StudyFigure rankings(const Results& r, const std::string& mark) {
  plot::StripPlot strips;
  strips.title = "Ranking of the places" + mark;
  strips.y_label = "pairs in the reference order [%]";
  for (const Ranking& k : r.rankings) {
    plot::Strip strip{k.title, {}, ""};
    for (const double v : k.pair_accuracy) strip.values.push_back(100 * v);
    strips.strips.push_back(std::move(strip));
  }
  return {
      "ranking", svg(strips),
      "Each dot is one person: of all pairs of places, the share not rated the wrong way round."};
}

StudyFigure rationality(const Rationality& r, const std::string& mark) {
  plot::StripPlot strips;
  strips.title = "Rationality" + mark;
  strips.y_label = "rating";
  strips.strips.push_back({"everyone", r.ratings.value, ""});
  strips.reference = r.reference;
  strips.reference_name = fmt::format("reference {}", r.reference);
  strips.width = 460;
  return {"rationality", svg(strips),
          "How well the stiffness of the whole head makes sense; each dot is one person."};
}

StudyFigure felt(const FeltAgainstMap& f, const Results& r, const std::string& mark) {
  plot::DotPlot dots;
  dots.title = "Felt against the map: " + f.title + mark;
  dots.x_label = "stiffness of the map at the touched point [N/mm], logarithms fitted";
  dots.y_label = "mean rating";
  dots.x_from_zero = dots.y_from_zero = true;
  for (std::size_t k = 0; k < r.regions.size(); ++k)
    dots.dots.push_back({f.stiffness[k], f.mean_rating[k], kNothing, kNothing, 1, r.regions[k]});
  const auto stiffness = st::numbers(f.stiffness);
  const auto [low, high] = std::minmax_element(stiffness.begin(), stiffness.end());
  plot::Series line;
  for (int i = 0; i <= 60 && low != stiffness.end(); ++i) {
    line.x.push_back(*low * std::pow(*high / *low, i / 60.0));
    line.y.push_back(f.line.intercept + f.line.slope * std::log(line.x.back()));
  }
  dots.curves.push_back(std::move(line));
  dots.note = fmt::format("Spearman {}, Pearson of the logarithm {}", fixed(f.spearman.r, 2),
                          fixed(f.pearson_log.r, 2));
  return {"felt-" + f.experiment, svg(dots),
          "Mean rating of each place over the stiffness that the head has there."};
}

StudyFigure psychometric(const Discrimination& d, const std::string& mark) {
  plot::DotPlot dots;
  dots.title = "Discrimination of stiffness" + mark;
  dots.x_label = "relative difference of stiffness";
  dots.y_label = "right choices [%]";
  dots.x_from_zero = true;
  dots.y_least = 0, dots.y_most = 100;
  double most = 0, trials = 0;
  for (const LevelShare& l : d.levels) {
    most = std::max(most, l.level);
    trials = std::max(trials, static_cast<double>(l.correct.trials));
  }
  for (const LevelShare& l : d.levels)
    dots.dots.push_back({l.level, 100 * l.correct.share, 100 * l.correct.wilson.low,
                         100 * l.correct.wilson.high,
                         2 * static_cast<double>(l.correct.trials) / trials, ""});
  if (std::isfinite(d.pooled.weber_fraction)) {
    plot::Series curve;
    for (int i = 1; i <= 120; ++i) {
      curve.x.push_back(most * i / 120);
      curve.y.push_back(100 * st::share_correct(curve.x.back(), d.pooled.weber_fraction,
                                                st::PsychometricOptions{}.lapse));
    }
    dots.curves.push_back(std::move(curve));
  }
  return {"discrimination", svg(dots),
          "All people's choices by class of difference; the dot's area is the number of choices. "
          "Curve: one "
          "observer fitted to all choices."};
}

StudyFigure weber_fractions(const Discrimination& d, const std::string& mark) {
  plot::StripPlot strips;
  strips.title = "Weber fractions" + mark;
  strips.y_label = "relative difference for 75 % right";
  for (const WeberRow& row : d.rows) {
    auto at = std::find_if(strips.strips.begin(), strips.strips.end(),
                           [&](const plot::Strip& s) { return s.label == row.region; });
    if (at == strips.strips.end()) at = strips.strips.insert(at, plot::Strip{row.region, {}, ""});
    at->values.push_back(row.fit.weber_fraction);
  }
  return {"weber", svg(strips), "One dot per person and place; smaller is finer."};
}

}  // namespace

std::vector<StudyFigure> study_figures(const StudyData& data, const Results& r) {
  // In the picture itself: it may travel without the page.
  const std::string mark = data.study.simulated ? " — simulated participants" : "";
  std::vector<StudyFigure> out;
  if (!r.conditions.empty()) {
    out.push_back(ratings_by_condition(r, mark));
    for (const Condition& c : r.conditions)
      if (c.id != "both") out.push_back(ratings_spread(c, r, mark));
  }
  for (const Grouping& g : r.groupings) out.push_back(groups(g, r, mark));
  if (!r.paired.empty()) out.push_back(pairs(r, mark));
  for (const bool toughest : {true, false})
    if (std::any_of(r.selections.begin(), r.selections.end(),
                    [toughest](const Selection& s) { return s.toughest == toughest; }))
      out.push_back(selection(r, toughest, mark));
  if (!r.rankings.empty()) out.push_back(rankings(r, mark));
  for (const Rationality& one : r.rationality) out.push_back(rationality(one, mark));
  for (const FeltAgainstMap& f : r.felt) out.push_back(felt(f, r, mark));
  if (!r.discrimination.rows.empty()) {
    out.push_back(psychometric(r.discrimination, mark));
    out.push_back(weber_fractions(r.discrimination, mark));
  }
  return out;
}

}  // namespace palpate::app
