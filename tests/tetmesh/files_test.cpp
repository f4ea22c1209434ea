// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.hpp"
#include "scenes.hpp"
#include "tetmesh/process.hpp"
#include "tetmesh/tetgen_files.hpp"

namespace palpate::tetmesh {
namespace {

struct Files {
  TemporaryFolder folder;
  std::filesystem::path node = folder.path() / "a.node", ele = folder.path() / "a.ele";
  void write(const std::string& nodes, const std::string& tets) const {
    std::ofstream(node) << nodes;
    std::ofstream(ele) << tets;
  }
};
const std::string kNodes = "4 3 0 0\n 0 0 0 0\n 1 1 0 0\n 2 0 1 0\n 3 0 0 1\n# by a mesher\n";
const std::string kTets = "1 4 1\n 0 0 1 2 3 2\n# by a mesher\n";

TEST(TetgenFiles, ReadsWhatTetgenWritesAndTurnsTetsOurWay) {
  const Files f;
  f.write(kNodes, "1 4 1\n 0 1 0 2 3 2\n");
  const auto r = read_tetgen(f.node, f.ele);
  ASSERT_EQ(r.nodes.size(), 4U);
  EXPECT_EQ(r.label, std::vector<int>{2});
  EXPECT_EQ(r.tets[0], (Tetrahedron{1, 0, 3, 2}));
}

TEST(TetgenFiles, RefusesEveryTruncation) {
  const Files f;
  // Beyond these lengths only the comment and the line's end are missing.
  const auto node_end = kNodes.find("0 0 1\n# ") + 5, ele_end = kTets.find(" 2\n# ") + 2;
  for (std::size_t n = 0; n < node_end; ++n) {
    f.write(kNodes.substr(0, n), kTets);
    EXPECT_THROW((void)read_tetgen(f.node, f.ele), SolveError) << n;
  }
  for (std::size_t n = 0; n < ele_end; ++n) {
    f.write(kNodes, kTets.substr(0, n));
    EXPECT_THROW((void)read_tetgen(f.node, f.ele), SolveError) << n;
  }
  f.write(kNodes, kTets);
  EXPECT_NO_THROW((void)read_tetgen(f.node, f.ele));
}

TEST(TetgenFiles, RefusesNonsense) {
  const Files f;
  for (const char* nodes : {"4 2 0 0\n", "4 3 0 0\n 0 0 0 nan\n", "-1 3 0 0\n",
                            "4 3 0 0\n 0 0 0 0\n 1 1 0 0\n 2 0 1 0\n 7 0 0 1\n"}) {
    f.write(nodes, kTets);
    EXPECT_THROW((void)read_tetgen(f.node, f.ele), SolveError) << nodes;
  }
  for (const char* tets : {"1 4 0\n 0 0 1 2 3\n", "1 4 1\n 0 0 1 2 4 1\n", "1 4 1\n 0 0 1 2 2 1\n",
                           "1 4 1\n 0 0 1 2 3 1.5\n", "1 4 1\n 0 0 1 2 3 1 5\n"}) {
    f.write(kNodes, tets);
    EXPECT_THROW((void)read_tetgen(f.node, f.ele), SolveError) << tets;
  }
}

TEST(Process, GivesTheExitCodeAndTheLastLine) {
  const TemporaryFolder folder;
  const auto log = folder.path() / "log";
  const auto run = [&](std::vector<std::string> args) {
    return run_process("sh", args, log, 10, 1, {}, "test");
  };
  auto r = run({"-c", "echo one; echo two >&2; echo; exit 3"});
  EXPECT_EQ(r.exit_code, 3);
  EXPECT_EQ(r.last_line, "two");
  EXPECT_EQ(run({"-c", "kill -9 $$"}).exit_code, 137);
  EXPECT_EQ(run_process("sh", {"-c", "echo dropped > litter"}, log, 10, 1, {}, "test").exit_code,
            0);
  EXPECT_TRUE(std::filesystem::exists(log.parent_path() / "litter"));
  EXPECT_FALSE(run_process("no-such-program", {}, log, 10, 1, {}, "test").found);
  EXPECT_TRUE(run_process("sleep", {"30"}, log, 0.1, 1, {}, "test").timed_out);
}

TEST(Process, TemporaryFolderLeavesNothing) {
  std::filesystem::path path;
  {
    const TemporaryFolder folder;
    path = folder.path();
    std::ofstream(path / "x") << "y";
    EXPECT_TRUE(std::filesystem::exists(path / "x"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace palpate::tetmesh
