// SPDX-License-Identifier: GPL-3.0-or-later
// The program as a user runs it, on the bundled head.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "core/atomic_file.hpp"
#include "io/head_file.hpp"
#include "io/scan.hpp"

namespace palpate {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kHead = fs::path(PALPATE_SOURCE_DIR) / "data/head.ply";

struct Outcome {
  int code = -1;
  std::string out, err;
};

class CommandLine : public testing::Test {
 protected:
  fs::path folder;
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             (std::string("palpate_apps_") +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  pid_t start(const std::vector<std::string>& words) const {
    const pid_t child = fork();
    if (child != 0) return child;
    const int out = open((folder / "out.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err = open((folder / "err.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    std::vector<char*> argv = {const_cast<char*>(PALPATE_PROGRAM)};
    for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(127);
  }
  Outcome wait_for(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            read_file(folder / "out.txt"), read_file(folder / "err.txt")};
  }
  Outcome palpate(const std::vector<std::string>& words) const { return wait_for(start(words)); }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::size_t lines(const std::string& text) const {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(CommandLine, BuildsTheBundledHeadTheSameOnOneAndTwoThreads) {
  const std::vector<std::string> common = {"build",  kHead.string(), "--mode",
                                           "exact",  "--sites",      "40",
                                           "--json", "--quiet",      "--no-report"};
  std::vector<json> described;
  for (const std::string threads : {"1", "2"}) {
    auto words = common;
    for (const std::string& w :
         {std::string("-o"), path(threads + ".glb"), std::string("--threads"), threads})
      words.push_back(w);
    const Outcome run = palpate(words);
    ASSERT_EQ(run.code, 0) << run.err;
    described.push_back(json::parse(run.out));
    described.back().erase("run");
  }
  EXPECT_EQ(described[0], described[1]);

  const io::Scan scan = io::read_scan(kHead);
  const TouchableHead one = io::read_head(folder / "1.glb");
  const TouchableHead two = io::read_head(folder / "2.glb");
  ASSERT_EQ(one.skin.points.size(), scan.mesh.points.size());
  for (std::size_t i = 0; i < scan.mesh.points.size(); ++i)
    ASSERT_EQ(one.skin.points[i], scan.mesh.points[i]) << "vertex " << i;
  EXPECT_EQ(one.skin.triangles, scan.mesh.triangles);
  // Not-a-number differs from itself: compare the bits.
  const auto same_bits = [](const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
  };
  EXPECT_TRUE(same_bits(one.map.displacement, two.map.displacement));
  EXPECT_EQ(one.skull.points, two.skull.points);
  EXPECT_EQ(one.map.method, two.map.method);
  EXPECT_TRUE(same_bits(one.map.dents.share, two.map.dents.share));
  EXPECT_DOUBLE_EQ(one.provenance["options"]["tissue_model"]["youngs_modulus_kpa"].get<double>(),
                   45.658);

  const json& head = described[0];
  EXPECT_EQ(head["provenance"]["fit"]["outside_count"], 0);
  EXPECT_EQ(head["status"]["failed"], 0);
  const Outcome csv =
      palpate({"export", path("1.glb"), "--skull", path("skull.ply"), "--csv", path("map.csv")});
  ASSERT_EQ(csv.code, 0) << csv.err;
  EXPECT_EQ(lines(read_file(folder / "map.csv")), scan.mesh.points.size() + 1);
  const Outcome inspect = palpate({"inspect", path("1.glb"), "--json"});
  ASSERT_EQ(inspect.code, 0) << inspect.err;
  EXPECT_EQ(json::parse(inspect.out)["vertices"], scan.mesh.points.size());
}

TEST_F(CommandLine, PrintsLandmarksInTheScansOwnNumbersAndTakesTheUsersOwn) {
  const fs::path edit = folder / "points.txt";
  write_file(edit, "# a point moved by hand\nfixed nasion 0.25 20 90\nfound chin 1 2 3 0.5\n");
  const Outcome run = palpate({"landmarks", kHead.string(), "--json", "--quiet", "--landmark",
                               "nose_tip=0.5,-20,106", "--edit", edit.string()});
  ASSERT_EQ(run.code, 0) << run.err;
  const json result = json::parse(run.out);
  EXPECT_EQ(result["unit_mm"], 1.0);
  EXPECT_EQ(result["landmarks"]["nose_tip"]["position"], json({0.5, -20.0, 106.0}));
  EXPECT_EQ(result["landmarks"]["nose_tip"]["confidence"], 1.0);
  EXPECT_EQ(result["landmarks"]["nasion"]["position"], json({0.25, 20.0, 90.0}));
  const std::string text = read_file(edit);
  EXPECT_NE(text.find("fixed nasion 0.25 20 90 1.00\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nfound eye_outer_left "), std::string::npos) << text;
  EXPECT_EQ(text.find("chin 1 2 3"), std::string::npos) << text;  // found anew
}

TEST_F(CommandLine, RefusesInOneLineAndLeavesNothing) {
  write_file(folder / "empty.obj", "");
  write_file(folder / "cut.ply", read_file(kHead).substr(0, 100000));
  write_file(folder / "lies.stl", read_file(kHead));
  write_file(folder / "bad.toml", "sites = 40\nsitez = 3\n");
  write_file(folder / "key.toml",
             "model = \"uniform\"\nsource = \"x\"\nyoungs_modulus = 3\npoissons_ratio = 0.4\n");
  write_file(folder / "soft.toml",
             "model = \"uniform\"\nsource = \"x\"\nyoungs_modulus_kpa = 0\npoissons_ratio = 0.4\n");
  write_file(folder / "cube.off",
             "OFF\n8 12 0\n0 0 0\n200 0 0\n200 200 0\n0 200 0\n0 0 200\n200 0 200\n200 200 200\n0 "
             "200 200\n"
             "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n3 2 "
             "7 6\n3 3 0 4\n3 3 4 7\n");
  const std::string out = path("head.glb");
  const std::vector<std::pair<std::vector<std::string>, int>> cases = {
      {{"build", path("empty.obj"), "-o", out, "--quiet"}, 2},
      {{"build", path("cut.ply"), "-o", out, "--quiet"}, 2},
      {{"build", path("lies.stl"), "-o", out, "--quiet"}, 2},
      {{"build", path("cube.off"), "-o", out, "--quiet"}, 2},
      {{"build", path("absent.ply"), "-o", out, "--quiet"}, 2},
      {{"build", kHead.string(), "-o", path("no/such/folder/head.glb"), "--quiet"}, 4},
      {{"build", kHead.string(), "-o", out, "--config", path("bad.toml")}, 2},
      {{"build", kHead.string(), "-o", out, "--sites", "many"}, 2},
      {{"build", kHead.string(), "-o", out, "--tissue-model", path("key.toml")}, 2},
      {{"build", kHead.string(), "-o", out, "--tissue-model", path("soft.toml")}, 2},
      {{"build", kHead.string(), "-o", out, "--tissue-model", "regional", "--poissons-ratio",
        "0.4"},
       2},
      {{"sweep", kHead.string(), "--shard", "3/2", "--checkpoint", path("c")}, 2},
      {{"sweep", kHead.string(), "--shard", "1/2"}, 2},
      {{"build", kHead.string(), "-o", out, "--preset", "published", "--mode", "exact"}, 2},
      {{"build", kHead.string(), "-o", out, "--preset", "published", "--tissue-model", "layered"},
       2},
      {{"sweep", kHead.string(), "-o", out, "--reach", "30"}, 2},
      {{"build", kHead.string(), "-o", out, "--landmark", "nose_tip=1;2;3"}, 2},
      {{"inspect", kHead.string()}, 2},
      {{"sculpt"}, 2},
  };
  for (const auto& [words, code] : cases) {
    const Outcome run = palpate(words);
    EXPECT_EQ(run.code, code) << words[1 % words.size()] << ": " << run.err;
    EXPECT_EQ(lines(run.err), 1u) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(fs::exists(out));
  }
  const auto with = [&cases](const std::string& word) {
    return std::find_if(cases.begin(), cases.end(),
                        [&](const auto& c) {
                          return std::find(c.first.begin(), c.first.end(), word) != c.first.end();
                        })
        ->first;
  };
  EXPECT_NE(palpate(with("layered")).err.find("--tissue-model: `--preset published`"),
            std::string::npos);
  EXPECT_NE(palpate(with("--reach")).err.find("--preset published` only"), std::string::npos);
  EXPECT_NE(palpate(cases[6].first).err.find("bad.toml:2"), std::string::npos);
  EXPECT_NE(palpate(cases[8].first).err.find("key.toml:3"), std::string::npos);
  EXPECT_NE(palpate(cases[9].first).err.find("youngs_modulus_kpa is 0"), std::string::npos);
}

TEST_F(CommandLine, KilledInTheSweepItGoesOnToTheSameBytes) {
  ASSERT_EQ(palpate({"fit", kHead.string(), "-o", path("skull.ply"), "--quiet"}).code, 0);
  const auto words = [&](const std::string& out) {
    return std::vector<std::string>{
        "sweep", kHead.string(), "--skull", path("skull.ply"), "--mode", "exact",  "--sites",
        "48",    "--loads",      "2",       "--quiet",         "-o",     path(out)};
  };
  ASSERT_EQ(palpate(words("whole.glb")).code, 0);
  auto kept = words("resumed.glb");
  kept.insert(kept.end(), {"--checkpoint", path("run.sweep")});
  constexpr std::uintmax_t kOneBatch = 1000;  // bytes: the header alone has 36
  const pid_t child = start(kept);
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    std::error_code absent;
    if (const auto size = fs::file_size(folder / "run.sweep", absent);
        !absent && size > kOneBatch) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_FALSE(fs::exists(folder / "resumed.glb"));
  const Outcome resumed = palpate(kept);
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_EQ(io::head_bytes_without_run(read_file(folder / "resumed.glb"), "resumed"),
            io::head_bytes_without_run(read_file(folder / "whole.glb"), "whole"));
}

TEST_F(CommandLine, RunsThePublishedRecipeAndSaysWhereItFails) {
  ASSERT_EQ(palpate({"fit", kHead.string(), "-o", path("skull.ply"), "--quiet"}).code, 0);
  write_file(folder / "thesis.toml", "preset = \"published\"\nsites = 2\nreach = 15\nloads = 1\n");
  const Outcome run = palpate({"sweep", kHead.string(), "--skull", path("skull.ply"), "--config",
                               path("thesis.toml"), "--quiet", "--json", "-o", path("head.glb")});
  ASSERT_EQ(run.code, 0) << run.err;
  const json head = json::parse(run.out);
  EXPECT_EQ(head["provenance"]["options"]["preset"], "published");
  EXPECT_EQ(head["status"]["solved"], 0);  // 5 N on one node
  EXPECT_GT(head["status"]["inverted"], 1000);
  ASSERT_EQ(head["provenance"]["published_sites"].size(), 2u);
  EXPECT_GT(head["provenance"]["published_sites"][0]["inverted_tets"].back(), 0);

  const TouchableHead file = io::read_head(folder / "head.glb");
  EXPECT_EQ(std::count(file.map.method.begin(), file.map.method.end(), SolveMethod::published), 2);
  const Outcome inspect = palpate({"inspect", path("head.glb")});
  EXPECT_NE(inspect.out.find("inverted: "), std::string::npos);
  EXPECT_NE(inspect.out.find("published recipe, 2 sites"), std::string::npos);
  const Outcome report =
      palpate({"report", path("head.glb"), "-o", path("report.html"), "--quiet"});
  ASSERT_EQ(report.code, 0) << report.err;
  EXPECT_NE(read_file(folder / "report.html").find("The published recipe"), std::string::npos);
}

TEST_F(CommandLine, StopsOnInterruptAndLeavesNothing) {
  const pid_t child = start({"build", kHead.string(), "-o", path("head.glb"), "--quiet"});
  std::this_thread::sleep_for(std::chrono::seconds(3));
  kill(child, SIGINT);
  const Outcome run = wait_for(child);
  EXPECT_EQ(run.code, 130) << run.err;
  EXPECT_TRUE(run.err.starts_with("palpate: stopped by the user")) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  for (const auto& entry : fs::directory_iterator(folder))
    EXPECT_TRUE(entry.path().extension() == ".txt") << entry.path();
}

// The first asks for a stop at the next step, the second does not wait for one; whichever comes to
// its end first says so.
TEST_F(CommandLine, ASecondInterruptStopsAtOnceAndSaysSo) {
  const pid_t child = start({"build", kHead.string(), "-o", path("head.glb"), "--quiet"});
  std::this_thread::sleep_for(std::chrono::seconds(3));
  kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  kill(child, SIGINT);
  const Outcome run = wait_for(child);
  EXPECT_EQ(run.code, 130) << run.err;
  EXPECT_NE(run.err.find("palpate: stopped "), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(folder / "head.glb"));
}

TEST_F(CommandLine, TeachesAndCompletes) {
  const Outcome help = palpate({"build", "--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--tool-radius"), std::string::npos);
  const Outcome completion = palpate({"completion"});
  EXPECT_EQ(completion.code, 0);
  EXPECT_NE(completion.out.find("--landmark-file"), std::string::npos);
}

}  // namespace
}  // namespace palpate
