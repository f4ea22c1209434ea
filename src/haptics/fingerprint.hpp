// SPDX-License-Identifier: Apache-2.0
// A 64-bit hash of plain values: tells whether a recording belongs to a model. Not cryptographic.
#pragma once
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace palpate::haptics {

/// @cite Fowler, Noll & Vo, FNV-1a, over 64-bit words instead of bytes
class Fingerprint {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(sizeof(T) <= 8 && std::is_arithmetic_v<T>);
    std::uint64_t word = 0;
    std::memcpy(&word, &value, sizeof(T));
    mix(word);
  }
  /// Vectors of plain data without padding.
  template <class T>
  void add(const std::vector<T>& values) {
    mix(values.size());
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    const std::size_t size = values.size() * sizeof(T);
    for (std::size_t at = 0; at < size; at += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + at, size - at < 8 ? size - at : 8);
      mix(word);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x100000001b3ULL;
    hash_ ^= hash_ >> 29;  // a word-wise FNV leaves high bits out of low ones
  }
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace palpate::haptics
