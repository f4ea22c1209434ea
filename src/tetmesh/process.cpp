// SPDX-License-Identifier: GPL-3.0-or-later
// posix_spawn(3) rather than fork: safe with threads running, and no copy of a large address space.
#include "tetmesh/process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "core/error.hpp"

namespace palpate::tetmesh {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPoll = std::chrono::milliseconds(20);

/// Owns the child until it has been waited for; ends it when an exception passes.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() { stop(); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// True once it has ended; `status` as waitpid(2) gives it.
  bool ended(int& status) {
    pid_t got;
    do got = waitpid(pid_, &status, WNOHANG);
    while (got < 0 && errno == EINTR);
    if (got == 0) return false;
    if (got < 0) status = 0xff00;
    pid_ = -1;
    return true;
  }
  void stop() {
    if (pid_ <= 0) return;
    kill(-pid_, SIGKILL);  // its whole process group
    int status;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }

 private:
  pid_t pid_;
};

/// Actions and attributes of the spawn, freed on every path.
struct SpawnSetup {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  SpawnSetup(const char* log, const char* folder) {
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, 1, log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&files, 1, 2);
    posix_spawn_file_actions_addchdir_np(&files, folder);
    posix_spawnattr_init(&attributes);
    // A group of its own: Ctrl-C reaches us alone, and we end it.
    posix_spawnattr_setpgroup(&attributes, 0);
    sigset_t defaults;
    sigemptyset(&defaults);
    for (const int s : {SIGINT, SIGTERM, SIGPIPE}) sigaddset(&defaults, s);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;
};

void read_last_words(const std::filesystem::path& log, ProcessResult& result) {
  constexpr std::streamoff kKeep = 4096;
  std::ifstream in(log, std::ios::binary | std::ios::ate);
  if (!in) return;
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kKeep));
  result.last_words.assign(std::istreambuf_iterator<char>(in), {});
  const std::string& words = result.last_words;
  const auto end = words.find_last_not_of(" \t\r\n");
  if (end == std::string::npos) return;
  const auto before = words.find_last_of('\n', end);
  const auto begin = before == std::string::npos ? 0 : before + 1;
  result.last_line = words.substr(begin, std::min<std::size_t>(200, end + 1 - begin));
}

/// @return pid, or 0 where there is no such program
pid_t spawn(const std::string& name, const std::vector<std::string>& arguments,
            const std::filesystem::path& log) {
  // A path given from here must still be right there.
  const bool is_path = name.find('/') != std::string::npos;
  const std::string program = is_path ? std::filesystem::absolute(name).string() : name;
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  const SpawnSetup setup(log.c_str(), std::filesystem::absolute(log).parent_path().c_str());
  pid_t pid = 0;
  const int error =
      posix_spawnp(&pid, program.c_str(), &setup.files, &setup.attributes, argv.data(), environ);
  if (error == ENOENT || error == EACCES || error == ENOTDIR) return 0;
  if (error) throw FileError(fmt::format("cannot start {}: {}", program, std::strerror(error)));
  return pid;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::path base = std::filesystem::temp_directory_path(ignored);
  if (base.empty()) base = "/tmp";
  std::string name = (std::filesystem::absolute(base) / "palpate-XXXXXX").string();
  if (!mkdtemp(name.data()))
    throw FileError(fmt::format("cannot make a temporary folder in {}: {}; set TMPDIR",
                                base.string(), std::strerror(errno)));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

ProcessResult run_process(const std::string& program, const std::vector<std::string>& arguments,
                          const std::filesystem::path& log, double time_limit_seconds,
                          double expected_seconds, const Progress& progress,
                          std::string_view stage) {
  ProcessResult result;
  const pid_t pid = spawn(program, arguments, log);
  if (pid == 0) {
    result.found = false;
    return result;
  }
  Child child(pid);
  const auto start = Clock::now();
  int status = 0;
  for (int poll = 0; !child.ended(status); ++poll) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (poll % 5 == 0) progress.step(stage, 1 - std::exp(-seconds / expected_seconds));
    if (seconds > time_limit_seconds) {
      child.stop();
      result.timed_out = true;
      break;
    }
    std::this_thread::sleep_for(kPoll);
  }
  if (!result.timed_out)
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  read_last_words(log, result);
  return result;
}

}  // namespace palpate::tetmesh
