// SPDX-License-Identifier: Apache-2.0
#include "core/atomic_file.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "core/error.hpp"

namespace palpate {
namespace {
namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  // One folder per test: they run side by side.
  fs::path folder = fs::path(testing::TempDir()) /
                    (std::string("palpate_atomic_file_") +
                     testing::UnitTest::GetInstance()->current_test_info()->name());
  void SetUp() override {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }
};

TEST_F(AtomicFile, ReplacesTheOldContentWhole) {
  write_file(folder / "a.txt", "old");
  write_file(folder / "a.txt", [](std::ostream& out) { out << "new"; });
  EXPECT_EQ(read_file(folder / "a.txt"), "new");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, AFailingWriterLeavesTheOldContentAndNoTemporary) {
  write_file(folder / "a.txt", "old");
  EXPECT_THROW(write_file(folder / "a.txt", [](std::ostream&) { throw std::runtime_error("x"); }),
               std::runtime_error);
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFile, SaysWhereItCannotWriteOrRead) {
  EXPECT_THROW(write_file(folder / "no/such/folder.txt", "x"), FileError);
  EXPECT_THROW((void)read_file(folder / "absent"), InputError);
  EXPECT_THROW((void)read_file(folder), InputError);
}

}  // namespace
}  // namespace palpate
