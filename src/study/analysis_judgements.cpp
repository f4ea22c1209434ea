// SPDX-License-Identifier: GPL-3.0-or-later
// Judgements against something outside: a reference order, a reference value, the map.
#include <algorithm>
#include <cmath>

#include "study/analysis_parts.hpp"
#include "study/statistics/effect_sizes.hpp"

namespace palpate::study {
namespace {

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

Selection selection(const Scene& scene, const Part& part, bool toughest) {
  Selection out;
  out.experiment = part.id;
  out.title = part.title;
  out.toughest = toughest;
  const auto& order = scene.data.protocol.analysis.reference_order;
  const auto wanted = static_cast<std::size_t>(toughest ? part.toughest : part.softest);
  for (std::size_t k = 0; k < std::min(wanted, order.size()); ++k)
    out.right.push_back(toughest ? order[k] : order[order.size() - 1 - k]);
  std::size_t people = 0, all_right = 0, made = 0, right = 0;
  std::vector<std::size_t> chosen(scene.regions.size(), 0);
  for (const Choice& c : scene.data.choices) {
    const auto& list = toughest ? c.toughest : c.softest;
    if (c.experiment != part.id || list.empty() || !scene.person(c.pseudonym)) continue;
    std::size_t hits = 0;
    for (const std::string& region : list) {
      hits += contains(out.right, region);
      if (const auto r = scene.region(region)) ++chosen[*r];
    }
    ++people;
    made += list.size();
    right += hits;
    all_right += hits == list.size();
  }
  out.choices = st::proportion(right, made);
  out.people = st::proportion(all_right, people);
  for (const std::size_t n : chosen)
    out.regions.push_back(st::proportion(std::min(n, people), people));
  return out;
}

/// Natural logarithms; a stiffness that is not positive becomes NaN.
std::vector<double> logarithms(const std::vector<double>& values) {
  std::vector<double> out;
  for (const double v : values) out.push_back(v > 0 ? std::log(v) : kNothing);
  return out;
}

}  // namespace

std::vector<Selection> selections(const Scene& scene) {
  std::vector<Selection> out;
  if (scene.order.empty()) return out;
  for (const Part& part : scene.data.protocol.parts) {
    if (part.kind != PartKind::experiment) continue;
    for (const bool toughest : {true, false})
      if ((toughest ? part.toughest : part.softest) > 0) {
        Selection s = selection(scene, part, toughest);
        if (s.people.trials > 0) out.push_back(std::move(s));
      }
  }
  return out;
}

std::vector<Ranking> rankings(const Scene& scene) {
  std::vector<Ranking> out;
  if (scene.order.empty()) return out;
  for (const Experiment& e : scene.experiments) {
    Ranking r;
    r.experiment = e.part->id;
    r.title = e.part->title;
    std::vector<double> means;
    for (const auto& row : e.rating) {
      r.tau_b.push_back(st::kendall(row, scene.order).tau_b);
      r.pair_accuracy.push_back(st::pair_accuracy(row, scene.order));
      r.perfect += r.pair_accuracy.back() == 1;
    }
    for (std::size_t k = 0; k < scene.regions.size(); ++k)
      means.push_back(st::moments(column(e.rating, k)).mean);
    r.accuracy = described(r.pair_accuracy);
    r.tau = st::moments(r.tau_b);
    r.of_means = st::kendall(means, scene.order);
    out.push_back(std::move(r));
  }
  return out;
}

std::vector<Rationality> rationality(const Scene& scene) {
  if (!scene.rationality || st::numbers(*scene.rationality).empty()) return {};
  Rationality out;
  out.ratings = described(*scene.rationality);
  out.reference = scene.data.protocol.analysis.rationality_reference;
  out.t = st::one_sample_t(out.ratings.moments, out.reference);
  std::vector<double> away;
  for (const double v : out.ratings.value) away.push_back(on_scale(v - out.reference));
  out.wilcoxon = st::wilcoxon_signed_rank(away);
  out.d = st::standardised_mean(out.ratings.moments, out.reference);
  out.normal = st::shapiro_wilk(out.ratings.value);
  return {out};
}

std::vector<FeltAgainstMap> felt_against_map(const Scene& scene) {
  std::vector<FeltAgainstMap> out;
  if (st::numbers(scene.stiffness).size() < 3) return out;
  const std::vector<double> log_stiffness = logarithms(scene.stiffness);
  for (const Experiment& e : scene.experiments) {
    FeltAgainstMap f;
    f.experiment = e.part->id;
    f.title = e.part->title;
    f.stiffness = scene.stiffness;
    for (std::size_t k = 0; k < scene.regions.size(); ++k)
      f.mean_rating.push_back(st::moments(column(e.rating, k)).mean);
    f.pearson = st::pearson(f.stiffness, f.mean_rating);
    f.pearson_log = st::pearson(log_stiffness, f.mean_rating);
    f.spearman = st::spearman(f.stiffness, f.mean_rating);
    f.line = st::fitted_line(log_stiffness, f.mean_rating);
    for (const auto& row : e.rating) f.rho.push_back(st::spearman(scene.stiffness, row).r);
    f.median_rho = st::median(f.rho);
    f.rho_against_zero = st::wilcoxon_signed_rank(f.rho);
    out.push_back(std::move(f));
  }
  return out;
}

std::vector<TouchSummary> touch_summaries(const Scene& scene) {
  std::vector<TouchSummary> out;
  for (const Part& part : scene.data.protocol.parts) {
    if (part.kind != PartKind::experiment && part.kind != PartKind::tutorial) continue;
    for (const std::string& region : scene.regions) {
      std::vector<double> duration, contact, peak;
      for (std::size_t i = 0; i < scene.data.trials.size(); ++i) {
        const TrialRecord& t = scene.data.trials[i];
        if (t.experiment != part.id || t.region != region || t.ended == 0 ||
            !scene.person(t.pseudonym))
          continue;
        duration.push_back(1e-3 * static_cast<double>(t.ended - t.started));
        if (scene.data.touch[i].samples == 0) continue;
        contact.push_back(scene.data.touch[i].contact_s);
        peak.push_back(scene.data.touch[i].peak_force);
      }
      if (!duration.empty())
        out.push_back(
            {part.id, region, st::moments(duration), st::moments(contact), st::moments(peak)});
    }
  }
  return out;
}

}  // namespace palpate::study
