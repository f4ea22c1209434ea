// SPDX-License-Identifier: Apache-2.0
// The bytes of a recording: shared by the writer and the reader.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "haptics/recording.hpp"

namespace palpate::haptics::codec {

inline constexpr std::string_view kMagic{"PALPTCH\x03", 8};
inline constexpr std::uint32_t kBlockMagic = 0x314b4c42;  // "BLK1"

/// CRC-32 of IEEE 802.3.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes);

template <class T>
void put(std::string& out, const T& value) {
  static_assert(std::endian::native == std::endian::little, "the format is little-endian");
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}
/// Takes a value off the front; false when there are too few bytes.
template <class T>
[[nodiscard]] bool get(std::string_view& in, T& value) {
  if (in.size() < sizeof(T)) return false;
  std::memcpy(&value, in.data(), sizeof(T));
  in.remove_prefix(sizeof(T));
  return true;
}

/// A tick as words; neighbours in time differ in few bytes of them.
inline constexpr int kTickWords = 15;
using TickWords = std::array<std::uint64_t, kTickWords>;
[[nodiscard]] TickWords to_words(const RecordedTick& tick);
[[nodiscard]] RecordedTick from_words(const TickWords& words);
/// Writes the bytes in which `words` differs from `previous`: per word half a byte with their
/// count, then the low bytes of the exclusive or (of the difference, for the two counts of time).
void put_difference(std::string& out, const TickWords& previous, const TickWords& words);
[[nodiscard]] bool get_difference(std::string_view& in, const TickWords& previous,
                                  TickWords& words);

/// All of a state, eight bytes a member.
void put_state(std::string& out, const TickState& state);
[[nodiscard]] bool get_state(std::string_view& in, TickState& state);

[[nodiscard]] std::string encode_header(const RecordingHeader& header);
/// Payload of one block, without its frame.
[[nodiscard]] std::string encode_block(const RecordedBlock& block);
[[nodiscard]] std::optional<RecordedBlock> decode_block(std::string_view payload);
/// Block with its magic, size and check sum in front.
[[nodiscard]] std::string framed(const std::string& payload);

}  // namespace palpate::haptics::codec
