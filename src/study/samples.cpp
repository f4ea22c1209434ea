// SPDX-License-Identifier: GPL-3.0-or-later
// A block is deflated planes, one after the other: for each channel all its differences in a row.
// Positions move smoothly, so their second differences are small; forces and times take first ones.
// A difference is written as a zigzag varint: one byte for -64 ... 63.
#include "study/samples.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>

#include "core/error.hpp"

namespace palpate::study {
namespace {

using Bytes = std::basic_string<unsigned char>;
constexpr int kNumbers = 7;                    // time, position, force
constexpr double kLargest = 1e9;               // [quanta] 100 m, 100 kN
constexpr std::size_t kMostSamples = 100'000;  // a damaged count asks for no more memory

void put_varint(Bytes& out, std::int64_t value) {
  auto zigzag = (static_cast<std::uint64_t>(value) << 1U) ^ static_cast<std::uint64_t>(value >> 63);
  while (zigzag >= 0x80) {
    out.push_back(static_cast<unsigned char>(zigzag | 0x80));
    zigzag >>= 7U;
  }
  out.push_back(static_cast<unsigned char>(zigzag));
}

[[noreturn]] void damaged() {
  throw InputError("damaged samples");
}

struct Reader {
  const unsigned char* at;
  const unsigned char* end;
  std::int64_t varint() {
    std::uint64_t zigzag = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      if (at == end) damaged();
      const unsigned char byte = *at++;
      zigzag |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if (byte < 0x80)
        return static_cast<std::int64_t>(zigzag >> 1U) ^ -static_cast<std::int64_t>(zigzag & 1U);
    }
    damaged();
  }
};

std::int64_t quantised(double value, double quantum) {
  const double n = std::round(value / quantum);
  if (!(std::abs(n) <= kLargest))
    throw InputError("a haptic sample is not finite or beyond 100 m or 100 kN");
  return static_cast<std::int64_t>(n);
}

std::array<std::int64_t, kNumbers> to_numbers(const HapticSample& s) {
  std::array<std::int64_t, kNumbers> n{s.time_us};
  for (int k = 0; k < 3; ++k) {
    n[static_cast<std::size_t>(1 + k)] = quantised(s.position[k], kPositionQuantum);
    n[static_cast<std::size_t>(4 + k)] = quantised(s.force[k], kForceQuantum);
  }
  return n;
}

bool second_order(std::size_t channel) {
  return channel <= 3;  // time and position
}

std::string deflated(const Bytes& plain) {
  uLongf size = compressBound(plain.size());
  std::string out(size, '\0');
  constexpr int kLevel = 4;  // 6 saves 2 % and takes twice the time
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, plain.data(), plain.size(), kLevel) !=
      Z_OK)
    throw std::bad_alloc();
  out.resize(size);
  return out;
}

void put_u32(std::string& out, std::size_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<char>((value >> shift) & 0xFFU));
}
std::size_t get_u32(std::string_view bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

}  // namespace

std::string encode_samples(std::span<const HapticSample> samples) {
  std::vector<std::array<std::int64_t, kNumbers>> numbers;
  numbers.reserve(samples.size());
  for (const HapticSample& s : samples) numbers.push_back(to_numbers(s));
  Bytes plain;
  plain.reserve(samples.size() * 10);
  for (std::size_t c = 0; c < kNumbers; ++c) {
    std::int64_t last = 0, step = 0;
    for (const auto& n : numbers) {
      const std::int64_t difference = n[c] - last;
      put_varint(plain, second_order(c) ? difference - step : difference);
      last = n[c];
      step = difference;
    }
  }
  for (const HapticSample& s : samples)
    plain.push_back(static_cast<unsigned char>((s.region << 1U) | (s.contact ? 1U : 0U)));
  std::string out;
  put_u32(out, samples.size());
  put_u32(out, plain.size());
  return out + deflated(plain);
}

std::vector<HapticSample> decode_samples(std::string_view bytes) {
  if (bytes.size() < 8) damaged();
  const std::size_t count = get_u32(bytes, 0), size = get_u32(bytes, 4);
  if (count > kMostSamples || size > count * (10 * kNumbers + 1)) damaged();
  Bytes plain(size, 0);
  uLongf got = size;
  if (uncompress(plain.data(), &got, reinterpret_cast<const Bytef*>(bytes.data() + 8),
                 bytes.size() - 8) != Z_OK ||
      got != size)
    damaged();
  std::vector<HapticSample> samples(count);
  Reader in{plain.data(), plain.data() + size};
  for (std::size_t c = 0; c < kNumbers; ++c) {
    // Unsigned: damaged differences may overflow.
    std::uint64_t last = 0, step = 0;
    for (HapticSample& s : samples) {
      const auto read = static_cast<std::uint64_t>(in.varint());
      step = second_order(c) ? step + read : read;
      last += step;
      const auto value = static_cast<std::int64_t>(last);
      if (c == 0)
        s.time_us = value;
      else if (c <= 3)
        s.position[static_cast<Eigen::Index>(c) - 1] =
            kPositionQuantum * static_cast<double>(value);
      else
        s.force[static_cast<Eigen::Index>(c) - 4] = kForceQuantum * static_cast<double>(value);
    }
  }
  if (static_cast<std::size_t>(in.end - in.at) != count) damaged();
  for (HapticSample& s : samples) {
    s.contact = (*in.at & 1U) != 0;
    s.region = static_cast<std::uint8_t>(*in.at++ >> 1U);
  }
  return samples;
}

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace palpate::study
