// SPDX-License-Identifier: GPL-3.0-or-later
// A whole study without people: the simulated hand presses, the simulated participant answers.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "apps/study_session.hpp"
#include "apps/study_touch.hpp"
#include "study/random.hpp"
#include "study/runner.hpp"

namespace palpate::app {
using nlohmann::json;
using study::HapticSample;
using study::Screen;

namespace {

constexpr double kHandStiffness = 0.5;  // [N/mm] of the arm
constexpr double kForce = 2.5;          // [N] of a probing finger
constexpr double kEnough = 6;           // [s] after which a simulated participant goes on
constexpr std::int64_t kTickNs = 1'000'000;

const study::StudyRegion& region_of(const study::Study& s, const std::string& name) {
  return *std::find_if(s.regions.begin(), s.regions.end(),
                       [&](const study::StudyRegion& r) { return r.name == name; });
}

/// Presses a posed place for a time; gives force over depth at the deepest.
class Presser {
 public:
  Presser(const OpenStudy& study, const study::StudyRegion& region, double factor, double largest,
          double seconds, double force)
      : hand_(probing({}, study.model.tool_radius, seconds, force, kHandStiffness), options()),
        setup_(study_setup(study.model, haptics::unlimited(), {}, factor, largest)),
        cycle_(setup_, hand_, pose_of(region, hand_.info()), cycle_options()) {}

  HapticSample tick() {
    now_ += kTickNs;
    cycle_.advance(now_, 0);
    const haptics::CycleSnapshot s = cycle_.latest();
    if (s.out.in_contact && s.out.depth > deepest_) {
      deepest_ = s.out.depth;
      stiffness_ = s.out.elastic / s.out.depth;
    }
    HapticSample sample;
    sample.time_us = now_ / 1000;
    sample.position = s.tool;
    sample.force = s.out.force;
    sample.contact = s.out.in_contact;
    sample.region = static_cast<std::uint8_t>(s.out.region);
    return sample;
  }
  [[nodiscard]] double stiffness() const { return stiffness_; }

 private:
  static haptics::SimulatedHandOptions options() {
    haptics::SimulatedHandOptions o;
    o.stiffness = kHandStiffness;
    return o;
  }
  static haptics::CycleOptions cycle_options() {
    haptics::CycleOptions o;
    o.clutch_button = -1;
    return o;
  }
  haptics::SimulatedHand hand_;
  haptics::TickSetup setup_;
  haptics::TouchCycle cycle_;
  std::int64_t now_ = 0;
  double deepest_ = 0, stiffness_ = 1e-3;
};

/// The study's regions as one press feels them, remembered.
class Feeling {
 public:
  explicit Feeling(const OpenStudy& study) : study_(study) {}
  double operator()(const std::string& region, double factor) {
    const auto key = std::pair(region, factor);
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
    constexpr double kOnePress = 1.9;  // [s]
    Presser press(study_, region_of(study_.study, region), factor, factor, kOnePress, kForce);
    for (double t = 0; t < kOnePress; t += 1e-3) (void)press.tick();
    return known_[key] = press.stiffness();
  }

 private:
  const OpenStudy& study_;
  std::map<std::pair<std::string, double>, double> known_;
};

struct Follower {
  const StudyOptions& options;
  const Say& say;
  const std::string& who;
  void answered(const std::string& key, const std::string& value) const {
    if (options.follow) say(json{{"answer", key}, {"participant", who}, {"value", value}}.dump());
  }
  void touched(const std::string& key, std::int64_t trial, int samples) const {
    if (options.follow)
      say(json{{"touched", key}, {"participant", who}, {"trial", trial}, {"samples", samples}}
              .dump());
  }
};

/// One touch screen: the trial's seconds, tick by tick.
void touch(OpenStudy& study, study::Runner& runner, const Follower& follow,
           const StudyOptions& options, const Progress& progress, double done) {
  const Screen screen = runner.screen();
  study::Random chance(options.simulation.seed, "press/" + screen.key,
                       static_cast<std::uint64_t>(runner.draw().order_index));
  double seconds = std::max(screen.least_s, kEnough) + chance.uniform();
  if (screen.interval > 0) seconds = std::max(screen.least_s, 1.9);
  if (screen.most_s > 0) seconds = std::min(seconds, screen.most_s);
  Presser press(study, region_of(study.study, screen.region), screen.factor,
                largest_factor(study.protocol, screen.part), seconds,
                kForce * (0.8 + 0.4 * chance.uniform()));
  const int ticks = static_cast<int>(seconds * 1000);
  constexpr int kSlice = 50;  // ticks between the runner's calls, as live
  std::vector<HapticSample> samples;
  for (int i = 1; i <= ticks; ++i) {
    samples.push_back(press.tick());
    if (i % kSlice != 0 && i != ticks) continue;
    const bool moved_on = runner.pass(1e-3 * static_cast<double>(samples.size()));
    if (moved_on) return;
    follow.touched(screen.key, runner.trial(), i);
    runner.add_samples(samples);
    samples.clear();
    progress.step("simulated participants", done);
  }
  runner.answer("done");
}

/// @return answers given
int run_one(OpenStudy& study, const std::string& who, Feeling& feeling, const StudyOptions& options,
            const Progress& progress, double done, const Say& say) {
  study::Runner runner(study.store, study.protocol, who);
  study::SimulatedParticipant mind(study.protocol, options.simulation, runner.draw(),
                                   std::ref(feeling));
  const Follower follow{options, say, who};
  int answers = 0;
  while (!runner.over()) {
    progress.step("simulated participants", done);
    const std::string key = runner.screen().key;
    if (runner.screen().kind == study::ScreenKind::touch)
      touch(study, runner, follow, options, progress, done);
    else
      runner.answer(mind.answer(runner.screen()));
    follow.answered(key, runner.answers().at(key));
    ++answers;
  }
  return answers;
}

}  // namespace

json run_simulated(OpenStudy& study, const StudyOptions& options, const Progress& progress,
                   const Say& say) {
  const auto start = std::chrono::steady_clock::now();
  Feeling feeling(study);
  const int wanted = study.study.planned_participants;
  while (study.store.next_order_index() < wanted)
    (void)study.store.enrol(true, draw_orders(study.protocol, study.study.regions, study.study.seed,
                                              study.store.next_order_index()));
  int answers = 0, finished = 0, excused = 0;
  bool stopped = false;
  try {
    for (const study::Participant& p : study.store.participants()) {
      using enum study::ParticipantState;
      const double done = static_cast<double>(p.order_index) / wanted;
      if (p.state == enrolled || p.state == running)
        answers += run_one(study, p.pseudonym, feeling, options, progress, done, say);
    }
    progress.step("simulated participants", 1);
  } catch (const Cancelled&) {
    stopped = true;  // what was committed stays; the same command goes on
  }
  for (const study::Participant& p : study.store.participants()) {
    finished += p.state == study::ParticipantState::finished;
    excused += p.state == study::ParticipantState::excused;
  }
  std::size_t samples = 0, bytes = 0;
  for (const study::SampleBlock& b : study.store.block_summaries()) {
    samples += b.count;
    bytes += b.bytes;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return {{"study", options.output.string()},
          {"simulated", true},
          {"participants", wanted},
          {"finished", finished},
          {"excused", excused},
          {"stopped", stopped},
          {"answers", answers},
          {"samples", samples},
          {"sample_bytes", bytes},
          {"seconds", took.count()},
          {"seed", study.study.seed}};
}

}  // namespace palpate::app
