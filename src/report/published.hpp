// SPDX-License-Identifier: GPL-3.0-or-later
// What the published recipe did at the sites where it was run (`--preset published`).
#pragma once
#include <vector>

#include "core/touchable_head.hpp"

namespace palpate::report {

/// Over all sites at one force. A site is good where the motion came to rest and no tissue was
/// turned inside out; elsewhere its travel means nothing, and is shown as what the recipe reports.
struct PublishedLoad {
  double force = 0;  ///< [N]
  int sites = 0, good = 0;
  int inverted = 0, restless = 0;  ///< at this force or, where it went no further, at a smaller one
  double median_good_u = 0;        ///< [mm] NaN where no site is good
  double median_u = 0;  ///< [mm] as reported by every site tried at this force; NaN where none
};
/// One per force of the map, from `provenance.published_sites` (docs/formats.md); empty where the
/// head was not made by the recipe or the record is not in order.
[[nodiscard]] std::vector<PublishedLoad> published_loads(const TouchableHead& head);

}  // namespace palpate::report
