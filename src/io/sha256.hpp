// SPDX-License-Identifier: Apache-2.0
// The hash that provenance records. Not for secrets.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace palpate::io {

/// SHA-256 (FIPS 180-4), fed in pieces. hex() may be called once.
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits.
  [[nodiscard]] std::string hex();

 private:
  void block(const unsigned char* p);
  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> pending_{};
  std::size_t held_ = 0;
  std::uint64_t total_ = 0;
};

[[nodiscard]] std::string sha256_hex(std::string_view bytes);

}  // namespace palpate::io
