// SPDX-License-Identifier: Apache-2.0
// What a test can set on, and read from, the stand-in for 3D Systems' HD library.
#pragma once
#include <atomic>

struct FakeHd {
  std::atomic<bool> present{true};
  std::atomic<unsigned> error{0};  // reported by hdGetError while not 0
  std::atomic<double> x{1}, y{2}, z{3};
  std::atomic<int> buttons{0};
  std::atomic<double> max_force{3.3};
  std::atomic<double> force_x{0}, force_y{0}, force_z{0};
  std::atomic<long> frames{0};
  std::atomic<bool> running{false};
  std::atomic<bool> stalled{false};  // the scheduler calls nobody
};
