// SPDX-License-Identifier: GPL-3.0-or-later
// A head in closed form with the seven regions of the published study, one below the other.
#pragma once
#include <algorithm>

#include "haptics/scenes.hpp"

namespace palpate::study::scenes {

inline TouchableHead seven_regions(int cuts = 24) {
  TouchableHead head = haptics::scenes::bumpy_head(cuts, 0.3, 8);
  // From the top down, with the travel that makes each softer than the last.
  constexpr std::array<SkinRegion, 7> kRegions = kPublishedOrder;
  constexpr std::array<double, 7> kSoftness = {0.8, 1.0, 1.25, 1.8, 2.3, 3.6, 5.5};
  const auto band = [](const Vec3& p) {
    return static_cast<std::size_t>(std::clamp((110 - p.y()) / 32, 0.0, 6.0));
  };
  head.map = haptics::scenes::stiffening_map(head.skin, 8,
                                             [&](const Vec3& p) { return kSoftness[band(p)]; });
  for (std::size_t v = 0; v < head.skin.points.size(); ++v)
    head.map.region[v] = kRegions[band(head.skin.points[v])];
  return head;
}

}  // namespace palpate::study::scenes
