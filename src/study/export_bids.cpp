// SPDX-License-Identifier: GPL-3.0-or-later
// Brain Imaging Data Structure, specification 1.8: modality-agnostic files and behavioural
// experiments. Times in a table are seconds from the start of the participant's first trial, so
// that no date of a person is published.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "study/export.hpp"
#include "study/table_text.hpp"

namespace palpate::study {
namespace {

using json = nlohmann::ordered_json;

/// Letters and digits only, as labels of BIDS entities must be.
std::string label(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) out += c;
  return out.empty() ? "x" : out;
}

std::string json_text(const json& j) {
  return j.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

std::string description(const Study& study) {
  json j;
  j["Name"] = study.title + (study.simulated ? " (simulated participants)" : "");
  j["BIDSVersion"] = "1.8.0";
  j["DatasetType"] = "raw";
  j["GeneratedBy"] = json::array({{{"Name", "Palpate"}, {"Version", study.program}}});
  j["Simulated"] = study.simulated;
  return json_text(j);
}

std::string readme(const StudyData& data) {
  std::string text = fmt::format(
      "{}\n\nProtocol {}, head {} (fingerprint {}). Written by {} from its study file.\n\n",
      data.study.title, data.study.protocol_name, data.study.head_name, data.study.head_fingerprint,
      data.study.program);
  if (data.study.simulated)
    text +=
        "Participants marked `simulated` are programs, not people. Do not publish them as "
        "people.\n\n";
  text +=
      "participants.tsv holds the background questions under pseudonyms; no names exist. Each\n"
      "beh table has one row per trial. The haptic samples (position, force, contact at 1 kHz) "
      "stay\n"
      "in the study file.\n";
  return text;
}

/// Background questions in the protocol's order that somebody answered.
std::vector<const Question*> background_questions(const StudyData& data) {
  std::set<std::string> given;
  for (const Participant& p : data.participants)
    for (const auto& [question, value] : p.background) given.insert(question);
  std::vector<const Question*> out;
  for (const Part& part : data.protocol.parts)
    for (const Question& q : part.questions)
      if (given.erase(q.id) > 0) out.push_back(&q);
  return out;
}

std::string column_name(const std::string& id) {
  std::string out = id;
  std::replace(out.begin(), out.end(), '-', '_');
  return out;
}

/// Participants of whom there are data.
bool exported(const Participant& p) {
  return p.state == ParticipantState::finished || p.state == ParticipantState::running;
}

std::string participants_tsv(const StudyData& data, const std::vector<const Question*>& questions) {
  std::vector<std::string> head = {"participant_id", "group", "simulated", "state", "order_index"};
  for (const Question* q : questions) head.push_back(column_name(q->id));
  TsvText out(head);
  for (const Participant& p : data.participants) {
    if (!exported(p)) continue;
    std::vector<std::string> row = {"sub-" + label(p.pseudonym), p.group,
                                    p.simulated ? "yes" : "no", std::string(name(p.state)),
                                    std::to_string(p.order_index)};
    for (const Question* q : questions) {
      const auto at = p.background.find(q->id);
      row.push_back(at == p.background.end() ? "" : at->second);
    }
    out.row(row);
  }
  return std::move(out).text();
}

std::string participants_json(const std::vector<const Question*>& questions) {
  json j;
  j["participant_id"] = {{"Description", "pseudonym; names were never stored"}};
  j["group"] = {{"Description", "answer to the question that the protocol groups by"}};
  j["simulated"] = {{"Description", "whether a program answered"},
                    {"Levels", {{"yes", "a program"}, {"no", "a person"}}}};
  j["state"] = {{"Description", "finished, or running when the table was written"}};
  j["order_index"] = {{"Description", "row of the balanced orders"}};
  for (const Question* q : questions) {
    json& column = j[column_name(q->id)];
    column["Description"] = q->text;
    for (const Option& o : q->options) column["Levels"][o.id] = o.text;
  }
  return json_text(j);
}

json quantity(const char* text, const char* unit) {
  json j = {{"Description", text}};
  if (*unit) j["Units"] = unit;
  return j;
}

std::string task_json(const StudyData& data, const Part& part) {
  json j;
  j["TaskName"] = label(part.id);
  j["TaskDescription"] = part.title;
  j["Instructions"] = part.text;
  j["Simulated"] = data.study.simulated;
  j["onset"] = quantity("start of the trial, from the start of the participant's first trial", "s");
  j["duration"] = quantity("length of the trial", "s");
  j["trial"] = quantity("number of the trial as the participant counts", "");
  j["region"] = quantity("place of the head at the middle of the device's workspace", "");
  j["interval"] = quantity("first or second press of a comparison", "");
  j["stiffness_factor"] = quantity("stiffness rendered over the map's", "");
  j["head_visible"] = quantity("whether the participant saw the head", "");
  j["rating"] =
      quantity(part.rating.text.empty() ? "rating of the stiffness" : part.rating.text.c_str(), "");
  j["rating"]["Minimum"] = part.rating.least;
  j["rating"]["Maximum"] = part.rating.most;
  j["description"] = quantity("where the place is, in the participant's words", "");
  j["contact"] = quantity("time in contact", "s");
  j["peak_force"] = quantity("largest force on the hand", "N");
  return json_text(j);
}

std::string trials_tsv(const StudyData& data, const Participant& person, const Part& part,
                       Moment origin) {
  TsvText out({"onset", "duration", "trial", "region", "interval", "stiffness_factor",
               "head_visible", "rating", "description", "contact", "peak_force"});
  bool any = false;
  for (std::size_t i = 0; i < data.trials.size(); ++i) {
    const TrialRecord& t = data.trials[i];
    if (t.pseudonym != person.pseudonym || t.experiment != part.id) continue;
    any = true;
    const TrialTouch& touch = data.touch[i];
    out.row({number_cell(1e-3 * static_cast<double>(t.started - origin)),
             t.ended ? number_cell(1e-3 * static_cast<double>(t.ended - t.started)) : "",
             std::to_string(t.index), t.region, t.interval ? std::to_string(t.interval) : "",
             number_cell(t.factor), t.head_visible ? "yes" : "no", number_cell(t.rating),
             t.description, touch.samples ? number_cell(touch.contact_s) : "",
             number_cell(touch.peak_force)});
  }
  return any ? std::move(out).text() : std::string();
}

Moment first_trial(const StudyData& data, const Participant& p) {
  Moment first = 0;
  for (const TrialRecord& t : data.trials)
    if (t.pseudonym == p.pseudonym && (first == 0 || t.started < first)) first = t.started;
  return first;
}

}  // namespace

std::vector<ExportFile> bids_files(const StudyData& data) {
  const auto questions = background_questions(data);
  std::vector<ExportFile> out = {{"bids/dataset_description.json", description(data.study)},
                                 {"bids/README", readme(data)},
                                 {"bids/participants.tsv", participants_tsv(data, questions)},
                                 {"bids/participants.json", participants_json(questions)}};
  for (const Part& part : data.protocol.parts) {
    bool any = false;
    for (const Participant& p : data.participants) {
      if (!exported(p)) continue;
      const std::string rows = trials_tsv(data, p, part, first_trial(data, p));
      if (rows.empty()) continue;
      any = true;
      const std::string subject = "sub-" + label(p.pseudonym);
      out.push_back(
          {fmt::format("bids/{0}/beh/{0}_task-{1}_beh.tsv", subject, label(part.id)), rows});
    }
    if (any)
      out.push_back({fmt::format("bids/task-{}_beh.json", label(part.id)), task_json(data, part)});
  }
  return out;
}

}  // namespace palpate::study
