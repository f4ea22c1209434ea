// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>

#include "study/analysis.hpp"
#include "study/store.hpp"

namespace palpate::study {

StudyData read_study(const Store& store) {
  StudyData out;
  out.study = store.study();
  out.protocol = parse_protocol(out.study.protocol_text, store.path().string());
  out.participants = store.participants();
  for (TrialRecord& t : store.trials())
    if (t.last_attempt) out.trials.push_back(std::move(t));
  out.choices = store.choices();
  out.comparisons = store.comparisons();
  out.answers = store.answers();
  std::map<std::int64_t, TrialTouch> touch;
  for (const SampleBlock& b : store.block_summaries()) {
    TrialTouch& t = touch[b.trial];
    t.samples += b.count;
    t.contact_s += b.contact_s;
    t.peak_force = std::fmax(t.peak_force, b.peak_force);  // fmax takes the number beside a NaN
  }
  for (const TrialRecord& t : out.trials) out.touch.push_back(touch[t.id]);
  return out;
}

}  // namespace palpate::study
