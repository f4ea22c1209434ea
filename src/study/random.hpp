// SPDX-License-Identifier: GPL-3.0-or-later
// Chance with an address: the same seed, label and numbers give the same draws on every machine,
// whatever else was drawn before. So a study that goes on after a crash draws what it would have.
#pragma once
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::study {

class Random {
 public:
  /// @param label  what the draws are for: "order/touch"
  /// @param a, b   further address, a participant's index for example
  Random(std::uint64_t seed, std::string_view label, std::uint64_t a = 0, std::uint64_t b = 0);

  [[nodiscard]] std::uint64_t next();                      ///< 64 bits (SplitMix64)
  [[nodiscard]] std::uint64_t below(std::uint64_t bound);  ///< even over 0 ... bound - 1; bound > 0
  [[nodiscard]] double uniform();                          ///< [0, 1)
  [[nodiscard]] double normal();                           ///< mean 0, standard deviation 1

  template <class T>
  void shuffle(std::vector<T>& values) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::uint64_t state_;
};

}  // namespace palpate::study
