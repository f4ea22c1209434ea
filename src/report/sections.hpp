// SPDX-License-Identifier: GPL-3.0-or-later
// The report's sections, in the order of the page. Each leaves out what the head does not carry.
#pragma once
#include "report/page.hpp"
#include "report/pictures.hpp"
#include "report/summary.hpp"

namespace palpate::report {

void add_overview(Page& page, const TouchableHead& head, const RegionSummary& summary);
void add_scan_and_landmarks(Page& page, const HeadPictures& pictures);
void add_skull(Page& page, const TouchableHead& head, const HeadPictures& pictures);
void add_depths(Page& page, const TouchableHead& head, const HeadPictures& pictures);
/// Nothing where the head states no spread.
void add_spread(Page& page, const TouchableHead& head, const HeadPictures& pictures);
void add_stiffness(Page& page, const TouchableHead& head, const RegionSummary& summary,
                   const HeadPictures& pictures);
void add_coverage(Page& page, const TouchableHead& head, const HeadPictures& pictures);
/// What the published recipe said at its sites; nothing for heads of the default preset.
void add_published(Page& page, const TouchableHead& head);
void add_tissue_mesh(Page& page, const TouchableHead& head);
void add_record(Page& page, const TouchableHead& head);

}  // namespace palpate::report
