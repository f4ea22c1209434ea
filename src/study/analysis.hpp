// SPDX-License-Identifier: GPL-3.0-or-later
// From what people answered to what can be said: a study's data as plain nouns, and all tests on
// them (docs/method/statistics.md says which and why). Only participants who finished count. NaN is
// "not asked, not answered, or no test possible"; nothing is filled in for it.
#pragma once
#include <string>
#include <vector>

#include "study/protocol.hpp"
#include "study/records.hpp"
#include "study/statistics/assumptions.hpp"
#include "study/statistics/correlation.hpp"
#include "study/statistics/kendall.hpp"
#include "study/statistics/proportions.hpp"
#include "study/statistics/psychometric.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/t_tests.hpp"

namespace palpate::study {

class Store;
namespace st = statistics;

/// How a trial was touched, from the blocks' summaries.
struct TrialTouch {
  std::size_t samples = 0;
  double contact_s = 0;          ///< [s]
  double peak_force = kNothing;  ///< [N]; NaN without samples
};

/// A study file as read; all that an analysis and an export need.
struct StudyData {
  Study study;
  Protocol protocol;
  std::vector<Participant> participants;  ///< all, in the order of enrolment
  std::vector<TrialRecord> trials;        ///< last attempts only
  std::vector<TrialTouch> touch;          ///< one per trial
  std::vector<Choice> choices;
  std::vector<Comparison> comparisons;
  std::vector<Answer> answers;
};
/// Reads the summaries of the haptic samples, not the samples: a large study stays quick.
/// @throws InputError  the file is damaged
[[nodiscard]] StudyData read_study(const Store& store);

/// A sample with what is printed of it. `value` has one entry per person counted, NaN if missing.
struct Described {
  std::vector<double> value;
  st::Moments moments;
  st::Interval interval{};  ///< 95 %, of the mean
  double median = kNothing;
};

/// Ratings under one condition: an experiment, or the mean of both.
struct Condition {
  std::string id, title;
  std::vector<Described> regions;  ///< in the order of Results::regions
};

/// Two groups of people on one quantity.
struct GroupTest {
  std::string quantity;  ///< region name, or "rationality"
  Described a, b;
  st::TTest welch;
  st::MannWhitney mann_whitney;
  double hedges_g = kNothing;
  st::ShapiroWilk normal_a, normal_b;
  st::SpreadTest spread;
  double welch_holm = kNothing, mann_whitney_holm = kNothing;  ///< over the regions
};
/// A background question that splits the people; its two most frequent answers are compared.
struct Grouping {
  std::string question, title;
  bool planned = false;             ///< the protocol names it; the others are exploratory
  std::vector<std::string> levels;  ///< all answers given, most frequent first
  std::vector<std::size_t> sizes;   ///< people per level
  std::vector<std::vector<Described>> by_level;  ///< ratings of both experiments: level, region
  std::vector<GroupTest> tests;  ///< regions, then rationality; empty where a level has one person
};

/// The same people by touch only and by touch and sight.
struct PairedTest {
  std::string region;
  std::vector<double> touch, sight;  ///< one per person; NaN where missing
  st::TTest t;                       ///< difference = sight - touch
  st::Wilcoxon wilcoxon;
  double d_z = kNothing;
  st::ShapiroWilk normal;  ///< of the differences
  double t_holm = kNothing, wilcoxon_holm = kNothing;
};

/// How often the right places were chosen as toughest or softest.
struct Selection {
  std::string experiment, title;
  bool toughest = true;
  std::vector<std::string> right;       ///< by the reference order
  st::Proportion choices;               ///< of all choices (the published measure)
  st::Proportion people;                ///< who chose all of them rightly
  std::vector<st::Proportion> regions;  ///< who chose this place, per region
};

/// Each person's ratings against the reference order.
struct Ranking {
  std::string experiment, title;
  std::vector<double> tau_b, pair_accuracy;  ///< one per person
  Described accuracy;
  st::Moments tau;
  std::size_t perfect = 0;  ///< people with every pair right
  st::Kendall of_means;     ///< the mean ratings against the order
};

struct Rationality {
  Described ratings;
  double reference = 8;
  st::TTest t;
  st::Wilcoxon wilcoxon;  ///< of rating - reference
  double d = kNothing;
  st::ShapiroWilk normal;
};

/// Ratings against the map's stiffness at the touched points.
struct FeltAgainstMap {
  std::string experiment, title;
  std::vector<double> stiffness, mean_rating;      ///< [N/mm], rating; per region
  st::Correlation pearson, pearson_log, spearman;  ///< of the means; log: of ln stiffness
  st::Line line;                                   ///< rating over ln stiffness
  std::vector<double> rho;                         ///< Spearman's of each person
  double median_rho = kNothing;
  st::Wilcoxon rho_against_zero;
};

struct WeberRow {
  std::string pseudonym, experiment, region;
  st::PsychometricFit fit;
};
struct LevelShare {
  double level = 0;  ///< [-] middle of a class of differences
  st::Proportion correct;
};
struct Discrimination {
  std::vector<WeberRow> rows;
  double geometric_mean = kNothing;  ///< of the people's Weber fractions
  st::Interval interval{};           ///< 95 %, by Student's t of their logarithms
  std::size_t unbounded = 0;         ///< rows without a Weber fraction
  st::PsychometricFit pooled;        ///< all choices as one observer; for the figure
  std::vector<LevelShare> levels;
};

struct TouchSummary {
  std::string experiment, region;
  st::Moments duration, contact, peak_force;  ///< [s], [s], [N]
};

struct Results {
  std::vector<std::string> regions;  ///< reference order if there is one, else the protocol's
  std::vector<std::string> people;   ///< pseudonyms of those counted
  std::size_t unfinished = 0, excused = 0, withdrawn = 0;
  std::vector<Condition> conditions;  ///< each experiment, then "both"
  std::vector<Grouping> groupings;    ///< the planned one first
  std::vector<PairedTest> paired;
  std::vector<Selection> selections;
  std::vector<Ranking> rankings;
  std::vector<Rationality> rationality;  ///< none or one
  std::vector<FeltAgainstMap> felt;
  Discrimination discrimination;
  std::vector<TouchSummary> touch;
};

/// @note Deterministic: no random numbers.
[[nodiscard]] Results analyse(const StudyData& data);

}  // namespace palpate::study
