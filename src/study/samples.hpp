// SPDX-License-Identifier: GPL-3.0-or-later
// Haptic samples as bytes: whole numbers of 0.1 um, 0.1 mN and 1 us, differences, deflate.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/records.hpp"

namespace palpate::study {

inline constexpr double kPositionQuantum = 1e-4;  ///< [mm]
inline constexpr double kForceQuantum = 1e-4;     ///< [N]

/// @throws InputError  a number that is not finite or beyond 100 m or 100 kN
[[nodiscard]] std::string encode_samples(std::span<const HapticSample> samples);
/// Whole or nothing. @throws InputError  damaged bytes
[[nodiscard]] std::vector<HapticSample> decode_samples(std::string_view bytes);
/// CRC-32 of IEEE 802.3, as zlib computes it.
[[nodiscard]] std::uint32_t checksum(std::string_view bytes);

}  // namespace palpate::study
