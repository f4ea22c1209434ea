// SPDX-License-Identifier: Apache-2.0
// Length units of scans. Inside, everything is millimetre, newton, second, megapascal.
#pragma once
#include <optional>
#include <string_view>

namespace palpate {

enum class LengthUnit { mm, cm, dm, m, inch };

/// Millimetres in one of the unit.
[[nodiscard]] constexpr double millimetres(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::mm:
      return 1.0;
    case LengthUnit::cm:
      return 10.0;
    case LengthUnit::dm:
      return 100.0;
    case LengthUnit::m:
      return 1000.0;
    case LengthUnit::inch:
      return 25.4;
  }
  return 1.0;
}
[[nodiscard]] constexpr std::string_view name(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::mm:
      return "mm";
    case LengthUnit::cm:
      return "cm";
    case LengthUnit::dm:
      return "dm";
    case LengthUnit::m:
      return "m";
    case LengthUnit::inch:
      return "inch";
  }
  return "mm";
}
[[nodiscard]] constexpr std::optional<LengthUnit> length_unit(std::string_view text) {
  for (const LengthUnit u :
       {LengthUnit::mm, LengthUnit::cm, LengthUnit::dm, LengthUnit::m, LengthUnit::inch})
    if (name(u) == text) return u;
  return std::nullopt;
}

}  // namespace palpate
