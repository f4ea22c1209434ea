// SPDX-License-Identifier: GPL-3.0-or-later
// Another run of a program beside this one, read without waiting.
#pragma once
#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace palpate::app {

/// Started without a copy of this process' memory (posix_spawn), so that a loop with locked memory
/// does not feel it. For one thread.
class ChildProcess {
 public:
  /// @param program  file; "/proc/self/exe" is this very program, also where a newer one has taken
  ///                 its place on disk
  /// @param words    its name and its arguments; both its outputs come back as lines
  /// @throws FileError  it cannot be started
  ChildProcess(const std::string& program, std::vector<std::string> words);
  ~ChildProcess();  ///< kills it where it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Lines that have come since the last call. Never waits.
  [[nodiscard]] std::vector<std::string> lines();
  /// Exit code (128 + signal where one ended it) once it is over. Never waits.
  [[nodiscard]] std::optional<int> ended();

 private:
  pid_t pid_ = 0;  // 0: over
  int pipe_ = -1;
  int code_ = 0;
  std::string rest_;  // a line that has not come whole
};

/// For the child itself, before it starts threads: lower priority from now on, and an end when
/// `parent` ends, however that does.
void serve_in_background(pid_t parent);

}  // namespace palpate::app
