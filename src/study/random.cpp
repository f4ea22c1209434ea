// SPDX-License-Identifier: GPL-3.0-or-later
// G. L. Steele, D. Lea, C. H. Flood: Fast splittable pseudorandom number generators, OOPSLA 2014.
#include "study/random.hpp"

#include <cmath>
#include <numbers>

namespace palpate::study {
namespace {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111eb;
  return z ^ (z >> 31U);
}

}  // namespace

Random::Random(std::uint64_t seed, std::string_view label, std::uint64_t a, std::uint64_t b)
    : state_(mixed(seed + kGolden)) {
  for (const char c : label) state_ = mixed(state_ + kGolden + static_cast<unsigned char>(c));
  state_ = mixed(state_ + kGolden * (a + 1));
  state_ = mixed(state_ + kGolden * (b + 1));
}

std::uint64_t Random::next() {
  state_ += kGolden;
  return mixed(state_);
}

// Draws that would make some values likelier are drawn again.
std::uint64_t Random::below(std::uint64_t bound) {
  const std::uint64_t unfair = (0 - bound) % bound;
  while (true) {
    const std::uint64_t draw = next();
    if (draw >= unfair) return draw % bound;
  }
}

double Random::uniform() {
  return static_cast<double>(next() >> 11U) * 0x1p-53;
}

double Random::normal() {
  const double radius = std::sqrt(-2 * std::log(1 - uniform()));
  return radius * std::cos(2 * std::numbers::pi * uniform());
}

}  // namespace palpate::study
