// SPDX-License-Identifier: Apache-2.0
// The tick neither allocates nor locks: operator new and the locks of the C library are counted.
#include <gtest/gtest.h>

#include "counters.hpp"
#include "haptics/tick.hpp"
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
