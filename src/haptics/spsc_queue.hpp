// SPDX-License-Identifier: Apache-2.0
// A queue from one thread to one other, of fixed size, without locks.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>

namespace palpate::haptics {

/// Holds up to N - 1 values. Neither end ever waits.
template <class T, std::size_t N>
class SpscQueue {
 public:
  /// The producer's side; false when full.
  bool push(const T& value) noexcept {
    const std::size_t at = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (at + 1) % N;
    if (next == head_.load(std::memory_order_acquire)) return false;
    slots_[at] = value;
    tail_.store(next, std::memory_order_release);
    return true;
  }
  /// The consumer's side; false when empty.
  bool pop(T& value) noexcept {
    const std::size_t at = head_.load(std::memory_order_relaxed);
    if (at == tail_.load(std::memory_order_acquire)) return false;
    value = slots_[at];
    head_.store((at + 1) % N, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, N> slots_{};
  alignas(64) std::atomic<std::size_t> head_{0};
  alignas(64) std::atomic<std::size_t> tail_{0};
};

}  // namespace palpate::haptics
