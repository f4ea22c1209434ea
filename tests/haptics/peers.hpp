// SPDX-License-Identifier: Apache-2.0
// Helpers for tests of devices whose peers run in threads of their own.
#pragma once
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>

#include "core/error.hpp"
#include "haptics/cycle.hpp"
#include "haptics/realtime.hpp"

namespace palpate::haptics {

// Waits until `holds`, at most two seconds: peers run in threads of their own.
template <class Condition>
bool soon(Condition holds) {
  for (int i = 0; i < 400; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}
inline std::string reason(const auto& open) {
  try {
    (void)open();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

// Presses 3 mm deep with the library's own clock, then the fault; returns the watchdog's word.
inline Trip trip_in_contact(const TickSetup& setup, Device& device, const Workspace& workspace,
                            const std::function<double()>& force,
                            const std::function<void()>& fault) {
  TouchCycle cycle(setup, device, workspace);
  std::int64_t late = 0;
  const auto turn = [&] {
    cycle.advance(monotonic_ns(), late);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  EXPECT_TRUE(soon([&] {
    for (int i = 0; i < 20; ++i) turn();
    return force() > 0.5;
  }));
  fault();
  Trip seen = Trip::none;
  EXPECT_TRUE(soon([&] {
    for (int i = 0; i < 20; ++i) {
      turn();
      if (cycle.latest().trip != Trip::none) seen = cycle.latest().trip;
    }
    return seen != Trip::none && force() == 0;
  }));
  return seen;
}

}  // namespace palpate::haptics
