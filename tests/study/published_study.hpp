// SPDX-License-Identifier: GPL-3.0-or-later
// A study of 25 whose rationality ratings are those of the published table, and whose other answers
// are set so that results can be worked out by hand.
#pragma once
#include <string>
#include <vector>

#include "study/analysis.hpp"

namespace palpate::study::test {

inline const std::vector<std::string>& reference_order() {
  static const std::vector<std::string> order = {"cranium", "forehead", "eyebrow", "cheekbone",
                                                 "jaw",     "chin",     "cheek"};
  return order;
}

inline Part experiment_part(const std::string& id, bool sight) {
  Part part;
  part.id = id;
  part.kind = PartKind::experiment;
  part.title = sight ? "By touch and sight" : "By touch alone";
  part.head_visible = sight;
  part.rating.text = "How stiff?";
  part.toughest = part.softest = 2;
  return part;
}

inline Protocol published_protocol() {
  Protocol p;
  p.name = "test";
  p.regions = reference_order();
  Part background;
  background.id = "background";
  background.kind = PartKind::questions;
  background.questions = {{"experience",
                           QuestionType::choice,
                           "Experience?",
                           {{"novice", "No"}, {"experienced", "Yes"}},
                           1,
                           10,
                           1,
                           "",
                           "",
                           false},
                          {"hand",
                           QuestionType::choice,
                           "Hand?",
                           {{"left", "Left"}, {"right", "Right"}},
                           1,
                           10,
                           1,
                           "",
                           "",
                           false}};
  p.parts = {background, experiment_part("touch", false), experiment_part("sight", true)};
  p.analysis = {
      "background/experience", reference_order(), "touch", "sight", "rationality/realism", 8};
  return p;
}

inline void add_person(StudyData& data, int number, const std::string& group, double realism) {
  Participant p;
  p.id = number;
  p.pseudonym = "P" + std::to_string(100 + number);
  p.order_index = number - 1;
  p.state = ParticipantState::finished;
  p.group = group;
  p.background = {{"experience", group}, {"hand", number == 1 ? "left" : "right"}};
  data.participants.push_back(p);
  data.answers.push_back({number, p.pseudonym, "rationality/realism", "rationality", "realism",
                          std::to_string(static_cast<int>(realism)), 1, 2});
  for (const bool sight : {false, true}) {
    for (std::size_t k = 0; k < 7; ++k) {
      TrialRecord t;
      t.id = static_cast<std::int64_t>(data.trials.size()) + 1;
      t.pseudonym = p.pseudonym;
      t.experiment = sight ? "sight" : "touch";
      t.index = static_cast<int>(k) + 1;
      t.region = reference_order()[k];
      t.head_visible = sight;
      t.started = 1000000 + 10000 * t.id;
      t.ended = t.started + 8000;
      // In the reference order; with sight the cheek is rated half a step higher by everybody.
      t.rating = 9 - static_cast<double>(k) + (sight && k == 6 ? 0.5 : 0) + 0.1 * (number % 3);
      data.trials.push_back(t);
      data.touch.push_back({8000, 5.5, 2.0 + 0.1 * static_cast<double>(k)});
    }
    // Every fifth person takes the eyebrow for one of the two toughest when not seeing.
    const bool wrong = !sight && number % 5 == 0;
    data.choices.push_back({p.pseudonym,
                            sight ? "sight" : "touch",
                            {"cranium", wrong ? "eyebrow" : "forehead"},
                            {"cheek", "chin"}});
  }
}

inline StudyData published_study() {
  StudyData data;
  data.protocol = published_protocol();
  data.study.title = "Test, with a comma";
  data.study.protocol_name = "test";
  data.study.planned_participants = 25;
  for (std::size_t k = 0; k < 7; ++k) {
    StudyRegion r;
    r.name = reference_order()[k];
    r.stiffness = r.stiffness_at_point = 2.0 / static_cast<double>(k + 1);
    data.study.regions.push_back(r);
  }
  const std::vector<double> experienced = {7, 7, 8, 8, 9, 9, 9};
  const std::vector<double> novice = {7, 7, 8, 8, 8, 8, 9, 9, 9, 9, 9, 9, 9, 9, 10, 10, 10, 10};
  int number = 0;
  for (const double r : experienced) add_person(data, ++number, "experienced", r);
  for (const double r : novice) add_person(data, ++number, "novice", r);
  return data;
}

}  // namespace palpate::study::test
