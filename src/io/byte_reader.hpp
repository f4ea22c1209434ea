// SPDX-License-Identifier: Apache-2.0
// Numbers out of raw bytes in a stated byte order, without alignment assumptions.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace palpate::io {

static_assert(std::endian::native == std::endian::little, "the readers assume a little-endian CPU");

template <typename T>
[[nodiscard]] inline T reversed(T value) {
  unsigned char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// @pre sizeof(T) bytes are readable at `p`
template <typename T>
[[nodiscard]] inline T load(const char* p, bool big_endian = false) {
  T value;
  std::memcpy(&value, p, sizeof(T));
  return big_endian ? reversed(value) : value;
}

enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] constexpr std::size_t byte_size(ScalarType t) {
  switch (t) {
    case ScalarType::i8:
    case ScalarType::u8:
      return 1;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    case ScalarType::i32:
    case ScalarType::u32:
    case ScalarType::f32:
      return 4;
    case ScalarType::f64:
      return 8;
  }
  return 1;
}

/// @pre byte_size(type) bytes are readable at `p`
[[nodiscard]] inline double load_scalar(const char* p, ScalarType type, bool big_endian) {
  switch (type) {
    case ScalarType::i8:
      return load<std::int8_t>(p);
    case ScalarType::u8:
      return load<std::uint8_t>(p);
    case ScalarType::i16:
      return load<std::int16_t>(p, big_endian);
    case ScalarType::u16:
      return load<std::uint16_t>(p, big_endian);
    case ScalarType::i32:
      return load<std::int32_t>(p, big_endian);
    case ScalarType::u32:
      return load<std::uint32_t>(p, big_endian);
    case ScalarType::f32:
      return load<float>(p, big_endian);
    case ScalarType::f64:
      return load<double>(p, big_endian);
  }
  return 0;
}

}  // namespace palpate::io
