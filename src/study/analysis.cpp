// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "study/analysis_parts.hpp"

namespace palpate::study {
namespace {

std::vector<const Participant*> finished_people(const StudyData& data) {
  std::vector<const Participant*> out;
  for (const Participant& p : data.participants)
    if (p.state == ParticipantState::finished) out.push_back(&p);
  return out;
}

std::size_t count_of(const StudyData& data, ParticipantState state) {
  return static_cast<std::size_t>(
      std::count_if(data.participants.begin(), data.participants.end(),
                    [state](const Participant& p) { return p.state == state; }));
}

std::vector<std::string> ordered_regions(const StudyData& data) {
  std::vector<std::string> out = data.protocol.analysis.reference_order;
  for (const StudyRegion& r : data.study.regions)
    if (std::find(out.begin(), out.end(), r.name) == out.end()) out.push_back(r.name);
  return out;
}

std::vector<Experiment> experiments_of(const Scene& scene) {
  std::vector<Experiment> out;
  const std::vector<double> empty(scene.regions.size(), kNothing);
  for (const Part& part : scene.data.protocol.parts) {
    if (part.kind != PartKind::experiment) continue;
    Experiment e{&part, RatingTable(scene.people.size(), empty)};
    bool any = false;
    for (const TrialRecord& t : scene.data.trials) {
      const auto who = scene.person(t.pseudonym);
      const auto where = scene.region(t.region);
      if (t.experiment != part.id || !who || !where || std::isnan(t.rating)) continue;
      e.rating[*who][*where] = t.rating;
      any = true;
    }
    if (any) out.push_back(std::move(e));
  }
  return out;
}

std::optional<std::vector<double>> rationality_of(const Scene& scene) {
  const std::string& key = scene.data.protocol.analysis.rationality;
  if (key.empty()) return std::nullopt;
  std::vector<double> out(scene.people.size(), kNothing);
  for (const Answer& a : scene.data.answers) {
    const auto who = scene.person(a.pseudonym);
    if (a.key != key || !who || a.value.empty()) continue;
    out[*who] = std::strtod(a.value.c_str(), nullptr);
  }
  return out;
}

std::vector<double> stiffness_of(const Scene& scene) {
  std::vector<double> out(scene.regions.size(), kNothing);
  for (const StudyRegion& r : scene.data.study.regions)
    if (const auto at = scene.region(r.name))
      out[*at] = std::isnan(r.stiffness_at_point) ? r.stiffness : r.stiffness_at_point;
  return out;
}

}  // namespace

const Experiment* Scene::experiment(const std::string& id) const {
  for (const Experiment& e : experiments)
    if (e.part->id == id) return &e;
  return nullptr;
}
std::optional<std::size_t> Scene::region(const std::string& name) const {
  const auto at = std::find(regions.begin(), regions.end(), name);
  if (at == regions.end()) return std::nullopt;
  return static_cast<std::size_t>(at - regions.begin());
}
std::optional<std::size_t> Scene::person(const std::string& pseudonym) const {
  for (std::size_t i = 0; i < people.size(); ++i)
    if (people[i]->pseudonym == pseudonym) return i;
  return std::nullopt;
}

double on_scale(double value) {
  return std::round(value * kRatingParts) / kRatingParts;
}
std::vector<double> on_scale(std::vector<double> values) {
  for (double& v : values) v = on_scale(v);
  return values;
}

Described described(std::vector<double> values) {
  Described out;
  out.moments = st::moments(values);
  out.interval = st::mean_interval(out.moments);
  out.median = st::median(values);
  out.value = std::move(values);
  return out;
}

std::vector<double> column(const RatingTable& table, std::size_t region) {
  std::vector<double> out;
  out.reserve(table.size());
  for (const auto& row : table) out.push_back(row[region]);
  return out;
}

Scene make_scene(const StudyData& data) {
  Scene scene{data, finished_people(data), ordered_regions(data), {}, {}, {}, {}};
  scene.experiments = experiments_of(scene);
  scene.stiffness = stiffness_of(scene);
  scene.rationality = rationality_of(scene);
  const auto& order = data.protocol.analysis.reference_order;
  if (order.empty()) return scene;
  for (const std::string& region : scene.regions) {
    const auto at = std::find(order.begin(), order.end(), region);
    scene.order.push_back(at == order.end() ? kNothing : static_cast<double>(order.end() - at));
  }
  return scene;
}

Results analyse(const StudyData& data) {
  const Scene scene = make_scene(data);
  Results out;
  out.regions = scene.regions;
  for (const Participant* p : scene.people) out.people.push_back(p->pseudonym);
  out.unfinished =
      count_of(data, ParticipantState::enrolled) + count_of(data, ParticipantState::running);
  out.excused = count_of(data, ParticipantState::excused);
  out.withdrawn = count_of(data, ParticipantState::withdrawn);
  out.conditions = conditions(scene);
  out.groupings = groupings(scene);
  out.paired = paired_tests(scene);
  out.selections = selections(scene);
  out.rankings = rankings(scene);
  out.rationality = rationality(scene);
  out.felt = felt_against_map(scene);
  out.discrimination = discrimination(scene);
  out.touch = touch_summaries(scene);
  return out;
}

}  // namespace palpate::study
