// SPDX-License-Identifier: Apache-2.0
// One writer hands its latest value to any number of readers; nobody waits for a lock.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace palpate::haptics {

/// The value is kept as atomic words between two counts, so that a reader that was overtaken reads
/// again. store() takes a bounded number of steps and never waits; load() repeats while the writer
/// is inside store(), which lasts well under a microsecond.
/// @tparam T  plain data: copied byte by byte, no pointers to follow
/// @cite Boehm 2012, "Can seqlocks get along with programming language memory models?"
template <class T>
class SeqLock {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  explicit SeqLock(const T& value = T{}) { store(value); }

  /// One thread only.
  void store(const T& value) noexcept {
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), static_cast<const void*>(&value), sizeof(T));
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    count_.store(count + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_relaxed);
    count_.store(count + 2, std::memory_order_release);
  }

  /// The latest value; any thread.
  [[nodiscard]] T load() const noexcept {
    std::uint64_t count = 0;
    return load(count);
  }
  /// The same with the number of the value: equal numbers mean the same value.
  [[nodiscard]] T load(std::uint64_t& number) const noexcept {
    std::array<std::uint64_t, kWords> words;
    for (;;) {
      const std::uint64_t before = count_.load(std::memory_order_acquire);
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_relaxed);
      std::atomic_thread_fence(std::memory_order_acquire);
      const std::uint64_t after = count_.load(std::memory_order_relaxed);
      if (before != after || before % 2 != 0) continue;
      number = before / 2;
      T value;
      std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
      return value;
    }
  }
  /// Number of values stored so far; a cheap way to see whether there is a new one.
  [[nodiscard]] std::uint64_t number() const noexcept {
    return count_.load(std::memory_order_acquire) / 2;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  std::atomic<std::uint64_t> count_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace palpate::haptics
