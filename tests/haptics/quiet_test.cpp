// SPDX-License-Identifier: Apache-2.0
// The tick neither allocates nor locks: operator new and the locks of the C library are counted.
// Nor does it call the system: a process that may do nothing but end lives through it.
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>

#include "counters.hpp"
#include "haptics/cycle.hpp"
#include "haptics/simulated_hand.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

TEST(Quiet, CountersCount) {
  const QuietScope quiet;
  ::operator delete(::operator new(8));  // a new expression could be optimised out
  EXPECT_EQ(quiet.allocations(), 1);
}

TEST(Quiet, ATickAllocatesNothingAndTakesNoLock) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(50, 2.0));
  const TickSetup setup = make_tick_setup(model, *limits_of("touch x"));
  TickState state;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<TickInput> inputs(20000);
  Vec3 p(0, 120, 0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (i % 500 == 499) p = 130 * Vec3(u(rng), u(rng), u(rng));  // jumps through the head too
    p += Vec3(u(rng), u(rng), u(rng));
    inputs[i].position = p;
    inputs[i].hold = i % 700 == 0;
    if (i % 900 == 0) inputs[i].position.x() = std::nan("");
  }
  double sum = 0;
  const QuietScope quiet;
  for (const TickInput& input : inputs) sum += tick(setup, input, state).force.norm();
  EXPECT_EQ(quiet.allocations(), 0);
  EXPECT_EQ(quiet.locks(), 0);
  EXPECT_GT(sum, 0);
}

enum class Ending { quiet, called_the_system, cannot_tell };

// Runs `work` in a child that the kernel kills at the first system call but the one that ends it.
Ending without_system_calls(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    sock_filter rules[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
    };
    const sock_fprog program{4, rules};
    if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
      ::_exit(2);
    work();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2) return Ending::cannot_tell;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? Ending::quiet : Ending::called_the_system;
}

TEST(Quiet, ATickMakesNoSystemCall) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  SimulatedHandOptions o;
  o.repeat = true;
  SimulatedHand hand(random_walk(model, 3, 10, 150), o);
  const auto file = std::filesystem::temp_directory_path() /
                    ("palpate_quiet_" + std::to_string(::getpid()) + ".touch");
  {
    Recorder recorder(file, setup, "simulated hand");
    TouchCycle cycle(setup, hand, Workspace{}, {}, &recorder);
    cycle.advance(1, 0);
    const Ending ending = without_system_calls([&] {
      for (std::int64_t i = 2; i < 5000; ++i) cycle.advance(i * 1'000'000, 0);
    });
    if (ending == Ending::cannot_tell) GTEST_SKIP() << "this system does not filter system calls";
    EXPECT_EQ(ending, Ending::quiet);
    EXPECT_EQ(without_system_calls([] { (void)::getppid(); }), Ending::called_the_system);
  }
  std::filesystem::remove(file);
}

TEST(Quiet, SameBitsForTheSameInput) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30, 2.0));
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  const auto run = [&] {
    TickState state;
    std::mt19937 rng(6);
    std::normal_distribution<double> g;
    Vec3 p(0, 114, 0), v = Vec3::Zero();
    std::vector<double> forces;
    for (int i = 0; i < 5000; ++i) {
      v += 2 * Vec3(g(rng), g(rng), g(rng)) - 0.05 * v - 0.5 * (p - Vec3(0, 110, 0));
      p += 0.001 * v;
      TickInput input;
      input.position = p;
      const TickOutput out = tick(setup, input, state);
      forces.insert(forces.end(), {out.force.x(), out.force.y(), out.force.z()});
    }
    return forces;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace palpate::haptics
