// SPDX-License-Identifier: GPL-3.0-or-later
// A large study: 100 people, 20 minutes of touch each at 1 kHz. Writes a real study file through
// the runner, then has `palpate study analyse` read it; prints size, time and memory as a table.
//   bench_study --program build/release/palpate [--participants 100] [--minutes 20] [--keep FILE]
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <random>

#include "study/runner.hpp"

namespace {

namespace fs = std::filesystem;
using namespace palpate;
using namespace palpate::study;
using Clock = std::chrono::steady_clock;

struct Options {
  fs::path program, keep;
  int participants = 100;
  double minutes = 20;
};

Options read_options(int argc, char** argv) {
  Options o;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string key = argv[i];
    if (key == "--program") o.program = argv[i + 1];
    if (key == "--keep") o.keep = argv[i + 1];
    if (key == "--participants") o.participants = std::atoi(argv[i + 1]);
    if (key == "--minutes") o.minutes = std::atof(argv[i + 1]);
  }
  return o;
}

/// Presses once in two seconds with a hand's tremor (10 Hz, 0.05 mm), the encoder's noise (0.02 mm)
/// and a spring's force: no smoother than a device.
class Hand {
 public:
  explicit Hand(std::uint64_t seed) : random_(seed) {}
  void fill(std::vector<HapticSample>& out, std::size_t count, double stiffness) {
    out.resize(count);
    for (HapticSample& s : out) {
      const double t = 1e-3 * static_cast<double>(tick_);
      const double tremor = 0.05 * std::sin(2 * std::numbers::pi * 10 * t);
      const double depth = 3 * std::sin(std::numbers::pi * t) + tremor + noise();
      s.time_us = 1000 * tick_++;
      s.position = {0.5 * std::sin(t) + noise(), 0.3 * std::cos(0.7 * t) + noise(), -depth};
      s.contact = depth > 0;
      s.force = s.contact ? Vec3(noise(), noise(), stiffness * depth) : Vec3::Zero();
      s.region = 1;
    }
  }

 private:
  double noise() {  // uniform, 0.02 mm standard deviation
    return 0.0346 * (2 * static_cast<double>(random_() >> 11U) / 9007199254740992.0 - 1);
  }
  std::mt19937_64 random_;
  std::int64_t tick_ = 0;
};

Study make_study(const Protocol& protocol, int participants) {
  Study s;
  s.id = std::string(32, '0');
  s.title = protocol.title;
  s.protocol_name = protocol.name;
  s.protocol_text = protocol.text;
  s.head_name = "bench";
  s.head_fingerprint = "none";
  s.seed = 1;
  s.program = "bench_study";
  s.created = now();
  s.planned_participants = participants;
  s.simulated = true;
  s.simulation = "{}";
  double stiffness = 2;
  for (const std::string& name : protocol.regions) {
    StudyRegion r;
    r.name = name;
    r.stiffness = r.stiffness_at_point = stiffness;
    stiffness *= 0.8;
    s.regions.push_back(r);
  }
  return s;
}

/// A word that the screen accepts; ratings spread over their range.
std::string word_for(const Screen& screen, std::uint64_t& chance) {
  chance = chance * 6364136223846793005U + 1442695040888963407U;
  const auto draw = static_cast<int>(chance >> 40U);
  if (screen.kind == ScreenKind::choose) {
    std::string places;
    for (int place = 1, left = screen.choose; left > 0; ++place)
      if (std::find(screen.barred.begin(), screen.barred.end(), place) == screen.barred.end()) {
        if (!places.empty()) places += ',';
        places += std::to_string(place);
        --left;
      }
    return places;
  }
  if (screen.kind == ScreenKind::consent) return "given";
  const Question& q = screen.question;
  if (screen.kind != ScreenKind::question) return "done";
  // The first answer of a tutorial's gate lets the participant on.
  if (q.type == QuestionType::choice)
    return q
        .options[screen.part == "tutorial" ? 0 : static_cast<std::size_t>(draw) % q.options.size()]
        .id;
  if (q.type == QuestionType::text) return "somewhere";
  const int steps = static_cast<int>((q.most - q.least) / q.step);
  return fmt::format("{}", q.least + q.step * (draw % (steps + 1)));
}

/// One participant; `seconds` of touch per trial.
std::size_t run_person(Store& store, const Protocol& protocol, const std::string& pseudonym,
                       double seconds, Hand& hand) {
  Runner runner(store, protocol, pseudonym);
  std::uint64_t chance = std::hash<std::string>()(pseudonym);
  std::vector<HapticSample> half_second;
  std::size_t samples = 0;
  while (!runner.over()) {
    if (runner.screen().kind != ScreenKind::touch) {
      runner.answer(word_for(runner.screen(), chance));
      continue;
    }
    const std::string key = runner.screen().key;
    for (double t = 0; t < seconds && runner.screen().key == key; t += 0.5) {
      const bool went_on = runner.pass(0.5);
      if (went_on) break;
      hand.fill(half_second, 500, 1.2);
      runner.add_samples(half_second);
      samples += half_second.size();
    }
    if (!runner.over() && runner.screen().key == key) runner.answer("done");
  }
  return samples;
}

/// The published protocol without limits of time, so that every trial takes its share.
Protocol long_protocol() {
  Protocol p = read_protocol(fs::path(PALPATE_SOURCE_DIR) / "protocols/head-stiffness-2015.toml");
  for (Part& part : p.parts) part.least_s = part.most_s = 0;
  return p;
}

int touches_of(const Protocol& p) {
  int n = 0;
  for (const Part& part : p.parts)
    n += rounds_of(part) *
         static_cast<int>((part.regions.empty() ? p.regions : part.regions).size()) *
         (part.kind == PartKind::experiment || part.kind == PartKind::tutorial);
  return n;
}

struct Run {
  int status = -1;
  double seconds = 0, peak_mib = 0;
};
Run analyse_with(const fs::path& program, const fs::path& file, const fs::path& folder) {
  const auto from = Clock::now();
  std::fflush(stdout);  // else the child would print it again
  const pid_t child = fork();
  if (child == 0) {
    if (!std::freopen("/dev/null", "w", stdout)) _exit(127);
    execl(program.c_str(), program.c_str(), "study", "analyse", file.c_str(), "-o", folder.c_str(),
          "--quiet", static_cast<char*>(nullptr));
    _exit(127);
  }
  Run out;
  rusage used{};
  int status = 0;
  if (wait4(child, &status, 0, &used) == child && WIFEXITED(status))
    out.status = WEXITSTATUS(status);
  out.seconds = std::chrono::duration<double>(Clock::now() - from).count();
  out.peak_mib = static_cast<double>(used.ru_maxrss) / 1024;
  return out;
}

int run(const Options& o) {
  const Protocol protocol = long_protocol();
  const fs::path folder = fs::temp_directory_path() / fmt::format("bench_study.{}", getpid());
  fs::create_directories(folder);
  const fs::path file = folder / "study.db";
  const auto from = Clock::now();
  std::size_t samples = 0;
  {
    Store store =
        Store::create(file, make_study(protocol, o.participants), Store::Durability::process);
    Hand hand(1);
    const double seconds = 60 * o.minutes / touches_of(protocol);
    for (int i = 0; i < o.participants; ++i) {
      const auto orders = draw_orders(protocol, store.study().regions, 1, store.next_order_index());
      samples += run_person(store, protocol, store.enrol(true, orders).pseudonym, seconds, hand);
    }
  }
  const double written = std::chrono::duration<double>(Clock::now() - from).count();
  const double gib = static_cast<double>(fs::file_size(file)) / (1024.0 * 1024 * 1024);
  fmt::print("| what | figure | wanted |\n|---|---|---|\n");
  fmt::print(
      "| participants, haptic samples | {}, {:.1f} million ({:.1f} min each at 1 kHz) | 100, 20 "
      "min |\n",
      o.participants, 1e-6 * static_cast<double>(samples),
      static_cast<double>(samples) / 60000 / o.participants);
  fmt::print("| study file | {:.2f} GiB, {:.1f} bytes a sample | <= 4 GB |\n", gib,
             static_cast<double>(fs::file_size(file)) / static_cast<double>(samples));
  fmt::print("| writing it | {:.0f} s ({:.0f} times real time) | |\n", written,
             1e-3 * static_cast<double>(samples) / written);
  const Run a = analyse_with(o.program, file, folder / "results");
  fmt::print("| palpate study analyse | {:.1f} s, exit code {} | <= 60 s |\n", a.seconds, a.status);
  fmt::print("| its largest memory | {:.0f} MiB | <= 1024 MiB |\n", a.peak_mib);
  if (!o.keep.empty()) fs::copy_file(file, o.keep, fs::copy_options::overwrite_existing);
  fs::remove_all(folder);
  return a.status;
}

}  // namespace

int main(int argc, char** argv) {
  const Options o = read_options(argc, argv);
  if (o.program.empty()) {
    fmt::print(stderr, "bench_study: name the program with --program build/release/palpate\n");
    return 2;
  }
  try {
    return run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_study: {}\n", error.what());
    return 1;
  }
}
