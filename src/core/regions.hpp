// SPDX-License-Identifier: Apache-2.0
// The two sets of regions (docs/method/regions.md): of the skull for the fit, of the skin for maps,
// tables and studies.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace palpate {

enum class SkullRegion : std::uint8_t {
  none,
  cranium,
  forehead,
  orbit,
  eyebrow,
  cheekbone,
  jaw,
  chin
};
inline constexpr std::array<std::string_view, 8> kSkullRegionNames = {
    "none", "cranium", "forehead", "orbit", "eyebrow", "cheekbone", "jaw", "chin"};

/// The seven regions of the published study, then the parts of `other`.
enum class SkinRegion : std::uint8_t {
  other,
  cranium,
  forehead,
  eyebrow,
  cheekbone,
  cheek,
  chin,
  jaw,
  eye,
  nose,
  lips,
  ear,
  neck
};
inline constexpr std::array<std::string_view, 13> kSkinRegionNames = {
    "other", "cranium", "forehead", "eyebrow", "cheekbone", "cheek", "chin",
    "jaw",   "eye",     "nose",     "lips",    "ear",       "neck"};
/// The seven, from stiff to soft as the source found them (docs/method/published.md).
inline constexpr std::array<SkinRegion, 7> kPublishedOrder = {
    SkinRegion::cranium, SkinRegion::forehead, SkinRegion::eyebrow, SkinRegion::cheekbone,
    SkinRegion::jaw,     SkinRegion::chin,     SkinRegion::cheek};

[[nodiscard]] constexpr std::string_view name(SkullRegion r) {
  return kSkullRegionNames[static_cast<std::size_t>(r)];
}
[[nodiscard]] constexpr std::string_view name(SkinRegion r) {
  return kSkinRegionNames[static_cast<std::size_t>(r)];
}

}  // namespace palpate
