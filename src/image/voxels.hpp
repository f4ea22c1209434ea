// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers share: numbers in any byte order, inflating, checks of a grid.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "image/volume.hpp"

namespace palpate::image {

enum class VoxelType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
[[nodiscard]] std::size_t bytes_of(VoxelType type);

/// @throws InputError always: "<name>: <what>; <remedy>"
[[noreturn]] void refuse(const std::string& name, const std::string& what,
                         const std::string& remedy);

/// Number at an offset that the caller has checked.
template <class T>
[[nodiscard]] T load(std::string_view bytes, std::size_t at, bool swap = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// Voxels in one volume; 1 to 2^30 in all, 2 to 8192 along each axis. @throws InputError otherwise
[[nodiscard]] std::size_t checked_count(const std::array<std::int64_t, 3>& size,
                                        const std::string& name);
/// `count` voxels as floats, value * slope + intercept. @throws InputError  too few bytes, or a
/// value that is not finite
[[nodiscard]] std::vector<float> to_floats(std::string_view bytes, VoxelType type, bool swap,
                                           std::size_t count, double slope, double intercept,
                                           const std::string& name);
/// Inflates a gzip stream up to `most` bytes. @throws InputError for a damaged stream
[[nodiscard]] std::string inflate_gzip(std::string_view bytes, std::size_t most,
                                       const std::string& name);
/// @throws InputError  edges outside 0.02 to 20 mm, or axes that span no space
void check_grid(const Volume& volume, const std::string& name);

}  // namespace palpate::image
