// SPDX-License-Identifier: GPL-3.0-or-later
// palpate study as a script runs it: unattended, killed, resumed, damaged, withdrawn.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/atomic_file.hpp"
#include "io/head_file.hpp"
#include "study/random.hpp"
#include "study/store.hpp"
#include "study/study_head.hpp"

namespace palpate {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using study::Store;

const std::string kProtocols = std::string(PALPATE_SOURCE_DIR) + "/protocols/";

struct Said {
  int code = -1;
  std::string out, error;
};
Said palpate(const std::string& words) {
  Said said;
  const fs::path errors = fs::temp_directory_path() / ("study_errors_" + std::to_string(getpid()));
  FILE* pipe =
      popen((std::string(PALPATE_PROGRAM) + " " + words + " 2>" + errors.string()).c_str(), "r");
  std::array<char, 4096> part{};
  while (const std::size_t n = fread(part.data(), 1, part.size(), pipe))
    said.out.append(part.data(), n);
  const int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  said.error = read_file(errors);
  fs::remove(errors);
  return said;
}

class StudyCommands : public testing::Test {
 protected:
  fs::path folder_ =
      fs::path(testing::TempDir()) / ("palpate_study_commands_" + std::to_string(getpid()));
  std::string head_ = (folder_ / "head.glb").string();
  std::string file_ = (folder_ / "study.db").string();
  std::string protocol_ = kProtocols + "head-stiffness-2015.toml";
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    io::write_head(head_, study::scenes::seven_regions());
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string run(const std::string& more, const std::string& file) const {
    return "study run " + protocol_ + " " + head_ + " -o " + file + " --simulate " + more;
  }
};

std::map<std::string, std::string> answers_of(const fs::path& file) {
  std::map<std::string, std::string> all;
  for (const study::Answer& a : Store::open(file, Store::Access::read).answers())
    all[a.pseudonym + " " + a.key] = a.value;
  return all;
}

TEST_F(StudyCommands, AWholeStudyRunsUnattendedAndIsMarkedAsSimulated) {
  const Said said = palpate(run("--participants 3 --seed 7 --json", file_));
  ASSERT_EQ(said.code, 0) << said.error;
  const json result = json::parse(said.out);
  EXPECT_EQ(result["finished"], 3);
  EXPECT_TRUE(result["simulated"].get<bool>());
  const Store store = Store::open(file_, Store::Access::read);
  EXPECT_TRUE(store.study().simulated);
  EXPECT_EQ(json::parse(store.study().simulation)["weber_fraction"], 0.15);
  for (const study::Participant& p : store.participants()) EXPECT_TRUE(p.simulated);
  EXPECT_EQ(store.trials().size(), 3U * 28);
  // Each place is felt: the stiffest with more force than the softest, all in contact for a while.
  std::map<std::int64_t, double> contact;
  for (const study::SampleBlock& b : store.block_summaries()) contact[b.trial] += b.contact_s;
  for (const study::TrialRecord& t : store.trials()) EXPECT_GT(contact[t.id], 1) << t.key;
  const Said check = palpate("study check " + file_);
  EXPECT_EQ(check.code, 0) << check.out;
  EXPECT_TRUE(check.out.starts_with("SIMULATED")) << check.out;
}

TEST_F(StudyCommands, TheDiscriminationRunsToo) {
  protocol_ = kProtocols + "stiffness-discrimination.toml";
  ASSERT_EQ(palpate(run("--participants 1 --weber 0.2 --quiet", file_)).code, 0);
  const Store store = Store::open(file_, Store::Access::read);
  const auto comparisons = store.comparisons();
  EXPECT_GT(comparisons.size(), 30U);
  std::map<std::string, int> series;
  for (const study::Comparison& c : comparisons) {
    EXPECT_EQ(c.index, ++series[c.region]);
    EXPECT_GT(c.difference, 0);
  }
  EXPECT_EQ(series.size(), 2U);
  EXPECT_EQ(palpate("study check " + file_).code, 0);
}

/// What the program said before it was killed.
struct Told {
  std::vector<json> answers;
  std::map<std::int64_t, int> samples;  // trial -> ticks
};

/// Starts the program, kills it after `lines` lines and `wait_us` more, or lets it end. True when
/// it ended by itself.
bool run_and_kill(const std::vector<std::string>& words, int lines, int wait_us, Told& told) {
  int ends[2];
  if (pipe(ends) != 0) std::abort();
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDERR_FILENO);
    std::vector<char*> arguments;
    for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  close(ends[1]);
  FILE* in = fdopen(ends[0], "r");
  char* line = nullptr;
  std::size_t size = 0;
  int seen = 0;
  bool killed = false;
  if (lines == 0) {
    std::this_thread::sleep_for(std::chrono::microseconds(wait_us));
    kill(child, SIGKILL);
    killed = true;
  }
  while (getline(&line, &size, in) > 0) {
    const json said = json::parse(line, nullptr, false);
    if (said.is_object() && said.contains("answer")) told.answers.push_back(said);
    if (said.is_object() && said.contains("touched"))
      told.samples[said["trial"].get<std::int64_t>()] = said["samples"].get<int>();
    if (++seen == lines && !killed) {
      std::this_thread::sleep_for(std::chrono::microseconds(wait_us));
      kill(child, SIGKILL);
      killed = true;
    }
  }
  free(line);
  fclose(in);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// PALPATE_KILLS says how many; `make study-kills` asks for 200.
TEST_F(StudyCommands, AKillAtAnyMomentLosesNoAnswerAndAtMostASecondOfSamples) {
  const char* asked = std::getenv("PALPATE_KILLS");
  const int kills = asked ? std::atoi(asked) : 24;
  const std::string straight = (folder_ / "straight.db").string();
  const std::string settings = "--participants 2 --seed 11";
  ASSERT_EQ(palpate(run(settings + " --quiet", straight)).code, 0);
  const auto expected = answers_of(straight);
  const std::vector<std::string> words = {
      PALPATE_PROGRAM, "study",          "run", protocol_, head_, "-o",      file_,
      "--simulate",    "--participants", "2",   "--seed",  "11",  "--follow"};
  study::Random chance(1, "kill");
  int done = 0, studies = 0, worst_lost = 0;
  while (done < kills) {
    Told told;
    // Of about 4000 lines a study, so that one study is killed several times.
    const int lines = static_cast<int>(chance.below(900));
    const bool ended = run_and_kill(words, lines, static_cast<int>(chance.below(20'000)), told);
    if (!fs::exists(file_)) {  // killed before there was a study
      ++done;
      continue;
    }
    {
      const Store store = Store::open(file_, Store::Access::read);
      const auto found = answers_of(file_);
      for (const json& a : told.answers) {
        const auto at =
            found.find(a["participant"].get<std::string>() + " " + a["answer"].get<std::string>());
        ASSERT_NE(at, found.end()) << "lost: " << a;
        EXPECT_EQ(at->second, a["value"]);
      }
      for (const auto& [key, value] : found) EXPECT_EQ(expected.at(key), value) << key;
      for (const auto& [trial, samples] : told.samples) {
        int kept = 0;
        for (const study::SampleBlock& b : store.block_summaries(trial))
          kept += static_cast<int>(b.count);
        worst_lost = std::max(worst_lost, samples - kept);
        EXPECT_LE(samples - kept, 1000) << "trial " << trial;
      }
      const Store reference = Store::open(straight, Store::Access::read);
      for (const study::Participant& p : store.participants()) {
        const auto plan = store.plan(p.pseudonym), wanted = reference.plan(p.pseudonym);
        ASSERT_EQ(plan.size(), wanted.size());
        for (std::size_t i = 0; i < plan.size(); ++i) EXPECT_EQ(plan[i].regions, wanted[i].regions);
      }
    }
    if (!ended) ++done;
    if (!ended) continue;
    EXPECT_EQ(answers_of(file_), expected) << "a study that was killed ends as one that was not";
    EXPECT_TRUE(study::check_store(file_).empty());
    fs::remove(file_);
    ++studies;
  }
  ASSERT_EQ(palpate(run(settings + " --quiet", file_)).code, 0);
  EXPECT_EQ(answers_of(file_), expected);
  std::printf("%d kills in %d studies: no answer lost, at most %d ms of samples\n", done,
              studies + 1, worst_lost);
}

TEST_F(StudyCommands, RefusesWhatIsNotThisStudy) {
  ASSERT_EQ(palpate(run("--participants 1 --seed 7 --quiet", file_)).code, 0);
  const std::string before = read_file(file_);
  const auto refused = [&](const std::string& words, const std::string& why) {
    const Said said = palpate(words);
    EXPECT_EQ(said.code, 2) << words;
    EXPECT_NE(said.error.find(why), std::string::npos) << said.error;
    EXPECT_EQ(std::count(said.error.begin(), said.error.end(), '\n'), 1) << said.error;
    EXPECT_TRUE(read_file(file_) == before) << words << " changed the file";
  };
  refused(run("--seed 8", file_), "seed is 7");
  refused(run("--seed 7 --weber 0.3", file_), "other settings");
  refused("study run " + protocol_ + " " + head_ + " -o " + file_ + " --no-open", "simulated");
  protocol_ = kProtocols + "stiffness-discrimination.toml";
  refused(run("--seed 7", file_), "another text of the protocol");
  protocol_ = kProtocols + "head-stiffness-2015.toml";
  io::write_head(head_, study::scenes::seven_regions(20));
  refused(run("--seed 7", file_), "another head");
  refused("study withdraw " + file_ + " P009", "no participant P009");
  refused("study check " + head_, "not a study file");
  refused("study run nothing.toml " + head_ + " -o " + file_, "nothing.toml");
}

TEST_F(StudyCommands, WithdrawsAndChecks) {
  ASSERT_EQ(palpate(run("--participants 2 --quiet", file_)).code, 0);
  EXPECT_EQ(palpate("study withdraw " + file_ + " P001").code, 0);
  const Said check = palpate("study check " + file_ + " --json");
  ASSERT_EQ(check.code, 0) << check.error;
  const json said = json::parse(check.out);
  EXPECT_EQ(said["participants"]["withdrawn"], 1);
  for (const study::Answer& a : Store::open(file_, Store::Access::read).answers())
    EXPECT_EQ(a.pseudonym, "P002");
}

}  // namespace
}  // namespace palpate
