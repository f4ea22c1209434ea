// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a study file and how an older file becomes a present one.
#pragma once
#include <span>

#include "study/sqlite.hpp"

namespace palpate::study {

inline constexpr std::int64_t kApplicationId = 0x50616C53;  // "PalS", in the file's header

/// From version n to n + 1, n being the step's place in the list.
struct SchemaStep {
  const char* sql;
  void (*fill)(Database& db);  ///< computes what new columns hold; null where nothing
};
/// As many as kStoreVersion. A step that was released is never changed, only followed by another.
[[nodiscard]] std::span<const SchemaStep> schema_steps();
/// Applies what is missing in one transaction: a kill leaves the old version or the new one.
void bring_up_to_date(Database& db);

}  // namespace palpate::study
