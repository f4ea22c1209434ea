// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "core/error.hpp"

extern char** environ;  // for posix_spawn

namespace palpate::app {

ChildProcess::ChildProcess(const std::string& program, std::vector<std::string> words) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    throw FileError(fmt::format("no pipe for a child process: {}", std::strerror(errno)));
  pipe_ = ends[0];
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int error = posix_spawn(&pid_, program.c_str(), &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (error == 0) return;
  close(pipe_);
  throw FileError(fmt::format("{}: cannot be started: {}", program, std::strerror(error)));
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(pipe_);
}

std::vector<std::string> ChildProcess::lines() {
  constexpr std::size_t kMost = 1U << 20;  // a line that long is none
  std::array<char, 4096> part{};
  for (ssize_t n; (n = read(pipe_, part.data(), part.size())) > 0 && rest_.size() < kMost;)
    rest_.append(part.data(), static_cast<std::size_t>(n));
  std::vector<std::string> whole;
  for (std::size_t end; (end = rest_.find('\n')) != std::string::npos; rest_.erase(0, end + 1))
    whole.push_back(rest_.substr(0, end));
  return whole;
}

std::optional<int> ChildProcess::ended() {
  if (pid_ == 0) return code_;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return {};
  pid_ = 0;
  constexpr int kSignal = 128;
  code_ = WIFEXITED(status) ? WEXITSTATUS(status) : kSignal + WTERMSIG(status);
  return code_;
}

void serve_in_background(pid_t parent) {
  constexpr int kLower = 5;  // nice value, as the page's server; 19 would starve on a busy machine
  setpriority(PRIO_PROCESS, 0, kLower);
  const sched_param none{};
  sched_setscheduler(0, SCHED_BATCH,
                     &none);  // does not preempt what sleeps and wakes, as a loop does
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) std::_Exit(0);  // it was over before this could be asked for
}

}  // namespace palpate::app
