// SPDX-License-Identifier: Apache-2.0
#include "haptics/realtime.hpp"

#include <fmt/format.h>
#include <linux/capability.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace palpate::haptics {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]

// The limit does not count for a process that may lock memory (CAP_IPC_LOCK, as root has it).
bool is_above_the_limit() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> own{};
  if (syscall(SYS_capget, &header, own.data()) != 0) return false;
  return ((own[CAP_IPC_LOCK / 32].effective >> (CAP_IPC_LOCK % 32)) & 1U) != 0;
}

// Locking everything with a small limit would make the next allocation fail, so only a lock without
// limit is asked for.
std::string lock_memory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const bool unlimited = limit.rlim_cur == RLIM_INFINITY;
  if (!unlimited && !is_above_the_limit()) {
    rlimit wish{RLIM_INFINITY, RLIM_INFINITY};
    if (setrlimit(RLIMIT_MEMLOCK, &wish) != 0)
      return fmt::format(
          "memory is not locked (limit {} KiB): a page fault can delay a tick; raise it with "
          "'ulimit -l unlimited' or memlock in /etc/security/limits.conf",
          limit.rlim_cur / 1024);
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    return fmt::format("memory is not locked ({}): a page fault can delay a tick",
                       std::strerror(errno));
  return {};
}

}  // namespace

std::int64_t monotonic_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

void sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec t{deadline_ns / kSecond, deadline_ns % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

std::vector<std::string> ask_for_realtime(int priority) {
  std::vector<std::string> refused;
  sched_param wish{};
  wish.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wish); error != 0)
    refused.push_back(
        fmt::format("no real-time priority ({}): other programs can delay a tick; allow it with "
                    "'ulimit -r {}' or rtprio in /etc/security/limits.conf",
                    std::strerror(error), priority));
  if (std::string line = lock_memory(); !line.empty()) refused.push_back(std::move(line));
  return refused;
}

void sharpen_timer() noexcept {
  prctl(PR_SET_TIMERSLACK, 1UL);  // [ns]
}

void prefault_stack() noexcept {
  constexpr std::size_t kDeepest = 64 * 1024;  // [byte] far more than a tick uses
  char stack[kDeepest];
  for (std::size_t i = 0; i < kDeepest; i += 4096) stack[i] = 0;
  asm volatile("" : : "r"(stack) : "memory");  // the writes are wanted although nobody reads them
}

}  // namespace palpate::haptics
