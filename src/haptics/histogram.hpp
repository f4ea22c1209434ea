// SPDX-License-Identifier: Apache-2.0
// How often a duration was how long: counted by the loop, read by anyone.
#pragma once
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>

namespace palpate::haptics {

/// Counts durations in buckets an eighth of an octave wide (at most 12.5 %), from 16 ns to over a
/// minute. One thread adds, any thread reads; no lock.
class DurationHistogram {
 public:
  static constexpr int kBuckets = 256;

  void add(std::int64_t nanoseconds) noexcept {
    const std::uint64_t ns = nanoseconds > 0 ? static_cast<std::uint64_t>(nanoseconds) : 0;
    bump(counts_[bucket(ns)]);
    bump(total_);
    if (ns > longest_.load(std::memory_order_relaxed))
      longest_.store(ns, std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t total() const noexcept {
    return total_.load(std::memory_order_relaxed);
  }
  /// [us] the longest of all, exact.
  [[nodiscard]] double longest_us() const noexcept {
    return 1e-3 * static_cast<double>(longest_.load(std::memory_order_relaxed));
  }
  /// [us] upper edge of the bucket that holds the given fraction of all; 0 when empty.
  [[nodiscard]] double quantile_us(double fraction) const noexcept {
    const auto wanted = fraction * static_cast<double>(total());
    double seen = 0;
    for (int i = 0; i < kBuckets; ++i) {
      seen += static_cast<double>(count(i));
      if (seen >= wanted && seen > 0) return upper_us(i);
    }
    return 0;
  }
  /// [-] share of durations in buckets beyond `us`.
  [[nodiscard]] double share_above_us(double us) const noexcept {
    std::uint64_t above = 0;
    for (int i = 0; i < kBuckets; ++i)
      if (lower_us(i) >= us) above += count(i);
    return total() ? static_cast<double>(above) / static_cast<double>(total()) : 0;
  }
  [[nodiscard]] std::uint64_t count(int index) const noexcept {
    return counts_[static_cast<std::size_t>(index)].load(std::memory_order_relaxed);
  }
  [[nodiscard]] static double lower_us(int index) noexcept {
    return index == 0 ? 0 : 1e-3 * edge(index);
  }
  [[nodiscard]] static double upper_us(int index) noexcept { return 1e-3 * edge(index + 1); }

 private:
  // Bucket 0 is below 16 ns; then eight to the octave.
  static std::size_t bucket(std::uint64_t ns) noexcept {
    if (ns < 16) return 0;
    const int octave = std::bit_width(ns) - 1;  // >= 4
    const auto eighth = (ns >> (octave - 3)) & 7U;
    const std::size_t index = 1 + static_cast<std::size_t>(octave - 4) * 8 + eighth;
    return index < kBuckets ? index : kBuckets - 1;
  }
  static double edge(int index) noexcept {
    const int octave = 4 + (index - 1) / 8;
    return static_cast<double>((8ULL + static_cast<unsigned>((index - 1) % 8)) << (octave - 3));
  }
  // Only one thread writes, so a load and a store do.
  static void bump(std::atomic<std::uint64_t>& c) noexcept {
    c.store(c.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
  std::atomic<std::uint64_t> total_{0};
  std::atomic<std::uint64_t> longest_{0};
};

}  // namespace palpate::haptics
