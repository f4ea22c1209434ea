// SPDX-License-Identifier: GPL-3.0-or-later
// touch, replay, feel and devices as a script runs them.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "haptics/scenes.hpp"
#include "io/head_file.hpp"

namespace palpate {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

struct Said {
  int code = -1;
  std::string out;
};
/// @param words  for the shell; messages for people are left out
Said palpate(const std::string& words) {
  Said said;
  FILE* pipe = popen((std::string(PALPATE_PROGRAM) + " " + words + " 2>/dev/null").c_str(), "r");
  std::array<char, 4096> part{};
  while (const std::size_t n = fread(part.data(), 1, part.size(), pipe))
    said.out.append(part.data(), n);
  const int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return said;
}

class TouchCommands : public testing::Test {
 protected:
  fs::path folder_ =
      fs::path(testing::TempDir()) / ("palpate_touch_commands_" + std::to_string(getpid()));
  std::string head_ = (folder_ / "head.glb").string();
  std::string recording_ = (folder_ / "visit.touch").string();
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    io::write_head(head_, haptics::scenes::even_sphere(20, 90, 0.8));
  }
  void TearDown() override { fs::remove_all(folder_); }
};

TEST_F(TouchCommands, ARecordedTouchReplaysBitForBit) {
  const Said touch =
      palpate("touch " + head_ +
              " --device simulated:falcon --seconds 1 --no-page --json --record " + recording_);
  ASSERT_EQ(touch.code, 0) << touch.out;
  const json report = json::parse(touch.out);
  EXPECT_GT(report["loop"]["ticks"].get<int>(), 100);
  EXPECT_EQ(report["recording"]["dropped"], 0);
  std::uint64_t late = 0, ticks = 0;
  for (const json& row : report["loop"]["histogram"]) {
    late += row["late"].get<std::uint64_t>();
    ticks += row["tick"].get<std::uint64_t>();
  }
  EXPECT_EQ(late, report["loop"]["ticks"].get<std::uint64_t>()) << "every deadline is in a row";
  EXPECT_EQ(ticks, late);
  const std::string csv = (folder_ / "visit.csv").string();
  const Said replay =
      palpate("replay " + recording_ + " --head " + head_ + " --csv " + csv + " --json");
  ASSERT_EQ(replay.code, 0);
  const json again = json::parse(replay.out);
  EXPECT_EQ(again["ticks"], report["recording"]["ticks"]);
  EXPECT_EQ(again["replay"]["different"], 0);
  EXPECT_NEAR(again["replay"]["passivity_removed_n_mm"].get<double>(),
              report["loop"]["passivity_removed_n_mm"].get<double>(), 1e-9);
  EXPECT_TRUE(read_file(csv).starts_with("time_s,"));
  io::write_head(head_, haptics::scenes::even_sphere(20, 90, 0.9));
  EXPECT_EQ(palpate("replay " + recording_ + " --head " + head_).code, 2) << "another head";
}

TEST_F(TouchCommands, TheReportShowsTheHistogram) {
  const Said touch =
      palpate("touch " + head_ + " --device simulated --seconds 0.3 --no-page --report");
  ASSERT_EQ(touch.code, 0);
  for (const char* word : {"lateness", "watchdog", "passivity", "below", " us "})
    EXPECT_NE(touch.out.find(word), std::string::npos) << word << "\n" << touch.out;
}

TEST_F(TouchCommands, ARegionIsWhereTheHandStays) {
  const std::string touch = "touch " + head_ + " --no-page --seconds 1.5 --json --device ";
  ASSERT_EQ(palpate(touch + "simulated --region forehead --record " + recording_).code, 0);
  const std::string csv = (folder_ / "visit.csv").string();
  ASSERT_EQ(palpate("replay " + recording_ + " --csv " + csv).code, 0);
  EXPECT_NE(read_file(csv).find(",1,forehead,"), std::string::npos);
  EXPECT_EQ(palpate(touch + "pointer --region nowhere").code, 2);
  EXPECT_EQ(palpate(touch + "pointer --region lips").code, 2) << "the sphere has no lips";
}

TEST_F(TouchCommands, ThePublishedPresetIsTheFalcons) {
  const std::string touch =
      "touch " + head_ + " --no-page --seconds 0.2 --preset published --device ";
  ASSERT_EQ(palpate(touch + "simulated:falcon --record " + recording_).code, 0);
  EXPECT_NE(read_file(recording_).find("\"peak_force_n\":8.7"), std::string::npos);
  EXPECT_EQ(palpate(touch + "simulated:omega").code, 2);
}

TEST_F(TouchCommands, FeelGivesTheCurvesForce) {
  const Said feel = palpate("feel " + head_ + " --at 0,0,91 --depth 2.5 --json");
  ASSERT_EQ(feel.code, 0);
  const json said = json::parse(feel.out);
  EXPECT_NEAR(said["depth_mm"].get<double>(), 2.5, 0.05);
  EXPECT_NEAR(said["force_n"].get<double>(), 0.8 * said["depth_mm"].get<double>(), 1e-6);
  EXPECT_EQ(palpate("feel " + head_ + " --at 500,0,0").code, 2);
  EXPECT_EQ(palpate("feel " + head_).code, 2);
}

TEST_F(TouchCommands, ServesAndEndsByItself) {
  const Said view = palpate("view " + head_ + " --no-open --port 0 --seconds 0.3 --json");
  ASSERT_EQ(view.code, 0);
  const json first = json::parse(view.out.substr(0, view.out.find('\n')));
  EXPECT_TRUE(first["url"].get<std::string>().starts_with("http://127.0.0.1:"));
  const Said open = palpate("view " + head_ + " --no-open --listen 0.0.0.0 --seconds 0.3 --json");
  EXPECT_NE(open.out.find("?token="), std::string::npos);
}

TEST_F(TouchCommands, RefusesWhatCannotBe) {
  EXPECT_EQ(palpate("touch nope.glb --no-page --seconds 1").code, 2);
  EXPECT_EQ(palpate("touch " + head_ + " --no-page --seconds 1 --device nothing").code, 2);
  EXPECT_EQ(palpate("touch " + head_ + " --no-page --seconds 1 --device simulated:nothing").code,
            2);
  EXPECT_EQ(palpate("touch " + head_ + " --no-page --seconds 1 --rate 50").code, 2);
  EXPECT_EQ(palpate("replay " + head_).code, 2);
}

// The vendor's library is found by its name where the loader looks, as for a user.
TEST_F(TouchCommands, ADeviceIsFoundFeltAndItsLossTold) {
  const fs::path libraries = folder_ / "lib";
  fs::create_directories(libraries);
  fs::create_symlink(FAKE_DHD, libraries / "libdhd.so.3");
  const char* search = std::getenv("LD_LIBRARY_PATH");
  const std::string before = search ? search : "";
  ::setenv("LD_LIBRARY_PATH", (libraries.string() + ":" + before).c_str(), 1);
  ::setenv("FAKE_DHD_LOST_AFTER", "300", 1);
  const json all = json::parse(palpate("devices --json").out);
  const Said touch = palpate("touch " + head_ + " --no-page --seconds 1 --priority 0");
  const Said published = palpate(
      "touch " + head_ + " --no-page --seconds 0.2 --preset published --record " + recording_);
  ::unsetenv("FAKE_DHD_LOST_AFTER");
  ::setenv("LD_LIBRARY_PATH", before.c_str(), 1);
  EXPECT_EQ(all[1]["device"], "force-dimension:0");
  EXPECT_TRUE(all[1]["usable"].get<bool>()) << all[1];
  EXPECT_EQ(touch.code, 0);
  EXPECT_NE(touch.out.find("device: Novint Falcon"), std::string::npos) << touch.out;
  EXPECT_NE(touch.out.find("device lost: fake error"), std::string::npos) << touch.out;
  EXPECT_EQ(published.code, 0);
  EXPECT_NE(read_file(recording_).find("\"peak_force_n\":8.7"), std::string::npos);
}

TEST_F(TouchCommands, DevicesSayWhatIsMissing) {
  const json all = json::parse(palpate("devices --json").out);
  ASSERT_GE(all.size(), 4U);
  EXPECT_TRUE(all[0]["usable"].get<bool>());
  for (const json& d : all) EXPECT_FALSE(d["detail"].get<std::string>().empty()) << d;
}

}  // namespace
}  // namespace palpate
