// SPDX-License-Identifier: GPL-3.0-or-later
// The steps of analyse(); private to this folder.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "study/analysis.hpp"

namespace palpate::study {

/// Ratings are steps of a scale. Sums and differences of 0.1 are not exact in binary, and equal
/// ones must stay equal for tests by ranks: rounded to so many parts of 1, far finer than any
/// scale.
inline constexpr double kRatingParts = 1e9;
[[nodiscard]] double on_scale(double value);
[[nodiscard]] std::vector<double> on_scale(std::vector<double> values);

[[nodiscard]] Described described(std::vector<double> values);

/// Ratings by experiment: person, region.
using RatingTable = std::vector<std::vector<double>>;
struct Experiment {
  const Part* part = nullptr;
  RatingTable rating;
};

/// What the steps share: who counts, what was rated.
struct Scene {
  const StudyData& data;
  std::vector<const Participant*> people;
  std::vector<std::string> regions;
  std::vector<Experiment> experiments;             ///< those with ratings, in the protocol's order
  std::vector<double> order;                       ///< larger is stiffer, per region; empty: none
  std::vector<double> stiffness;                   ///< [N/mm] at the points, per region
  std::optional<std::vector<double>> rationality;  ///< per person

  [[nodiscard]] const Experiment* experiment(const std::string& id) const;
  [[nodiscard]] std::optional<std::size_t> region(const std::string& name) const;
  [[nodiscard]] std::optional<std::size_t> person(const std::string& pseudonym) const;
};
[[nodiscard]] Scene make_scene(const StudyData& data);

/// One region's column of a table.
[[nodiscard]] std::vector<double> column(const RatingTable& table, std::size_t region);
/// Means over the experiments that a person rated; the same shape.
[[nodiscard]] RatingTable mean_of(const std::vector<Experiment>& experiments);

[[nodiscard]] std::vector<Condition> conditions(const Scene& scene);
[[nodiscard]] std::vector<Grouping> groupings(const Scene& scene);
[[nodiscard]] std::vector<PairedTest> paired_tests(const Scene& scene);
[[nodiscard]] std::vector<Selection> selections(const Scene& scene);
[[nodiscard]] std::vector<Ranking> rankings(const Scene& scene);
[[nodiscard]] std::vector<Rationality> rationality(const Scene& scene);
[[nodiscard]] std::vector<FeltAgainstMap> felt_against_map(const Scene& scene);
[[nodiscard]] Discrimination discrimination(const Scene& scene);
[[nodiscard]] std::vector<TouchSummary> touch_summaries(const Scene& scene);

}  // namespace palpate::study
