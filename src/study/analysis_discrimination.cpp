// SPDX-License-Identifier: GPL-3.0-or-later
// Weber fractions: one fit per person, experiment and region. Over people, logarithms: a fraction
// is positive and its errors are ratios.
#include <algorithm>
#include <cmath>

#include "study/analysis_parts.hpp"

namespace palpate::study {
namespace {

/// Classes of differences for the figure, equal in ln: 0.15 is narrower than a staircase's steps
/// taken twice, so that neighbouring levels share a class only where they hold few choices.
constexpr double kClassWidth = 0.15;

std::vector<LevelShare> level_shares(const std::vector<st::ForcedChoice>& choices) {
  struct Count {
    std::size_t right = 0, all = 0;
    double sum = 0;
  };
  std::map<int, Count> classes;
  for (const st::ForcedChoice& c : choices) {
    Count& count = classes[static_cast<int>(std::floor(std::log(c.level) / kClassWidth))];
    ++count.all;
    count.right += c.correct;
    count.sum += c.level;
  }
  std::vector<LevelShare> out;
  for (const auto& [unused, count] : classes)
    out.push_back(
        {count.sum / static_cast<double>(count.all), st::proportion(count.right, count.all)});
  return out;
}

}  // namespace

Discrimination discrimination(const Scene& scene) {
  std::map<std::pair<std::size_t, std::string>, std::vector<st::ForcedChoice>> runs;
  std::vector<st::ForcedChoice> all;
  for (const Comparison& c : scene.data.comparisons) {
    const auto who = scene.person(c.pseudonym);
    if (!who || !(c.difference > 0)) continue;
    all.push_back({c.difference, c.correct()});
    runs[{*who, c.experiment + "\n" + c.region}].push_back(all.back());
  }
  Discrimination out;
  if (all.empty()) return out;
  std::map<std::size_t, std::vector<double>> logs;  // per person, over their runs
  for (const auto& [key, choices] : runs) {
    const std::size_t cut = key.second.find('\n');
    out.rows.push_back({scene.people[key.first]->pseudonym, key.second.substr(0, cut),
                        key.second.substr(cut + 1), st::fit_weber_fraction(choices)});
    const double w = out.rows.back().fit.weber_fraction;
    out.unbounded += std::isnan(w);
    logs[key.first].push_back(std::log(w));
  }
  std::vector<double> people;
  for (const auto& [who, values] : logs) people.push_back(st::moments(values).mean);
  const st::Moments m = st::moments(people);
  const st::Interval i = st::mean_interval(m);
  out.geometric_mean = std::exp(m.mean);
  out.interval = {std::exp(i.low), std::exp(i.high)};
  out.pooled = st::fit_weber_fraction(all);
  out.levels = level_shares(all);
  return out;
}

}  // namespace palpate::study
