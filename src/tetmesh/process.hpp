// SPDX-License-Identifier: GPL-3.0-or-later
// One program, run to its end without a shell, and a folder that goes away by itself.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.hpp"

namespace palpate::tetmesh {

/// A folder of its own, as an absolute path, under $TMPDIR (or /tmp), readable by this user only,
/// removed with all it holds by the destructor.
class TemporaryFolder {
 public:
  /// @throws FileError  names the folder and the system's reason
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct ProcessResult {
  int exit_code = 0;       ///< of the program; 128 + n where signal n ended it
  bool found = true;       ///< false where there is no such program
  bool timed_out = false;  ///< it was stopped at the time limit
  std::string last_line;   ///< last non-empty line that it wrote, at most 200 characters
  std::string last_words;  ///< last 4 kB that it wrote to either stream
};

/// Starts `program` (a name is looked for on PATH) with exactly these arguments, standard input
/// empty, both output streams kept in `log`, working in the log's folder, so that what it drops on
/// its way is gone with that. Paths among the arguments must be absolute. Waits;
/// progress.step(stage, ...) is called ten times a second, with a fraction that approaches 1 over
/// `expected_seconds`.
/// @throws Cancelled  from progress; the program has been ended by then
/// @throws FileError  the system cannot start any program
[[nodiscard]] ProcessResult run_process(const std::string& program,
                                        const std::vector<std::string>& arguments,
                                        const std::filesystem::path& log, double time_limit_seconds,
                                        double expected_seconds, const Progress& progress,
                                        std::string_view stage);

}  // namespace palpate::tetmesh
