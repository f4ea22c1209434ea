// SPDX-License-Identifier: Apache-2.0
// Regions of the skin that other organs than bone carry.
#pragma once
#include "core/regions.hpp"

namespace palpate {

/// An eye's globe or nasal cartilage lies under the skin.
[[nodiscard]] constexpr bool lies_on_organ(SkinRegion r) {
  return r == SkinRegion::eye || r == SkinRegion::nose;
}

/// Held by the source (4.4.1): these and the lips.
[[nodiscard]] constexpr bool is_organ(SkinRegion r) {
  return lies_on_organ(r) || r == SkinRegion::lips;
}

}  // namespace palpate
