// SPDX-License-Identifier: GPL-3.0-or-later
// Solved sites on disk as they come, so that a killed run goes on where it was.
//
// File: a header block, then blocks in the order of arrival. Each block is
//   "PSB1", u32 kind, u32 bytes, u64 hash of kind, bytes and payload, payload
// in the machine's little-endian order. A block that is cut (killed while writing, full disk) or
// whose hash is wrong counts as not there; reading goes on at the next "PSB1".
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "stiffness/site.hpp"

namespace palpate::stiffness {

/// FNV-1a, 64 bits: tells damage and mix-ups apart, not attacks.
class Fingerprint {
 public:
  void add(std::span<const std::byte> bytes);
  void add(const std::string& text);
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(std::span<const T> values) { add(std::as_bytes(values)); }
  void add(double value) { add(std::as_bytes(std::span(&value, 1))); }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

/// What a curve was solved with; part of a record's key.
enum class SolveLevel : std::uint32_t { coarse, full, unstructured, published };

class Checkpoint {
 public:
  /// In memory only.
  Checkpoint() = default;
  /// Opens or creates a file and takes in what it holds.
  /// @param job  fingerprint of everything that a curve depends on
  /// @throws InputError  the file is no checkpoint, or one of another head or other options
  /// @throws FileError   it cannot be opened, or another process is writing it
  Checkpoint(std::filesystem::path path, std::uint64_t job);
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// Takes in what another file of the same job holds; the file is only read.
  void absorb(const std::filesystem::path& path, std::uint64_t job);

  /// Null where the site was not solved yet. Valid until the next put().
  [[nodiscard]] const SiteCurve* find(SolveLevel level, std::int32_t site) const;
  /// Keeps curves; on disk, too, when this returns. From any thread.
  /// @throws FileError  the disk is full: what was stored before stays good
  void put(SolveLevel level, std::span<const std::int32_t> sites,
           std::span<const SiteCurve> curves);
  [[nodiscard]] std::size_t size() const;
  /// One line per damaged place that was passed over.
  [[nodiscard]] const std::vector<std::string>& damage() const { return damage_; }

 private:
  /// Returns where the last whole block ends.
  std::size_t read(const std::filesystem::path& path, const std::string& bytes, std::uint64_t job);
  void take(SolveLevel level, std::string_view payload);
  void append(const std::string& bytes);

  std::filesystem::path path_;
  int descriptor_ = -1;
  mutable std::mutex mutex_;
  std::map<std::pair<SolveLevel, std::int32_t>, SiteCurve> curves_;
  std::vector<std::string> damage_;
};

}  // namespace palpate::stiffness
