// SPDX-License-Identifier: GPL-3.0-or-later
// What the store's source files share; private to this folder.
#pragma once
#include <fmt/format.h>

#include <optional>

#include "core/error.hpp"
#include "study/protocol.hpp"
#include "study/sqlite.hpp"
#include "study/store.hpp"

namespace palpate::study {

/// An advisory lock on the file that the system drops when its holder dies. It is of another kind
/// than SQLite's own, so that readers come through. Held until after the database is closed:
/// closing a descriptor drops SQLite's locks of this process.
class RunLock {
 public:
  /// @throws InputError  another runner holds it
  explicit RunLock(const std::filesystem::path& path);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  int file_ = -1;
};

struct Store::Inner {
  std::filesystem::path path;
  Access access = Access::read;
  std::unique_ptr<RunLock> lock;
  std::unique_ptr<Database> db;
  std::optional<Protocol> protocol;  ///< parsed when first wanted

  ~Inner();
  [[nodiscard]] std::int64_t participant_id(const std::string& pseudonym);
};

struct BlockSummary {
  double peak_force = 0;  ///< [N]
  double contact_s = 0;   ///< [s]
};
[[nodiscard]] BlockSummary summarised(std::span<const HapticSample> samples);

/// Over all that an answer says.
[[nodiscard]] std::uint32_t answer_checksum(const std::string& pseudonym, const Answer& answer);

/// Part of a key before its first '/', and question after its last.
[[nodiscard]] std::string part_of(const std::string& key);
[[nodiscard]] std::string question_of(const std::string& key);

/// Checks magic, application, version and SQLite's quick check through a connection that cannot
/// write. Gives the version. @throws InputError
std::int64_t examine(const std::filesystem::path& path, bool thorough);

}  // namespace palpate::study
