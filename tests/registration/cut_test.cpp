// SPDX-License-Identifier: GPL-3.0-or-later
#include "registration/cut.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../skull/shapes.hpp"

namespace palpate::registration {
namespace {

/// A sphere of 80 mm whose lower part is pressed flat onto y = -50.
HeadSurface flat_bottomed() {
  HeadSurface head = skull::head_of(skull::ellipsoid({80, 80, 80}, 0, 5));
  for (Vec3& p : head.skin.points) p.y() = std::max(p.y(), -50.0);
  return head;
}

TEST(ScanEnds, AClosedRoundHeadHasNone) {
  const ScanEnds ends = find_scan_ends(skull::head_of(skull::ellipsoid({75, 110, 95}, 0, 5)));
  EXPECT_TRUE(ends.planes.empty());
}

TEST(ScanEnds, AFlatFaceOfAClosedScanIsAnEnd) {
  const HeadSurface head = flat_bottomed();
  const ScanEnds ends = find_scan_ends(head);
  ASSERT_EQ(ends.planes.size(), 1u);
  EXPECT_NEAR(ends.planes[0].normal.y(), -1, 1e-9);
  EXPECT_NEAR(ends.planes[0].offset, 50, 1e-9);
  for (std::size_t i = 0; i < head.skin.points.size(); ++i) {
    if (ends.cap[i]) {
      EXPECT_NEAR(head.skin.points[i].y(), -50, 1e-9);
    } else {
      EXPECT_FALSE(ends.no_scan[i]);
    }
  }
}

TEST(ScanEnds, WhatRepairClosedIsAnEndOnlyWhereItIsLarge) {
  HeadSurface head = skull::head_of(skull::ellipsoid({80, 80, 80}, 0, 5));
  for (std::size_t i = 0; i < head.skin.points.size(); ++i) {
    const Vec3& p = head.skin.points[i];
    head.filled[i] = p.y() < -60 || p.z() > 78;  // a neck of 106 mm and an eye of 35 mm width
  }
  const ScanEnds ends = find_scan_ends(head);
  ASSERT_EQ(ends.planes.size(), 1u);
  EXPECT_NEAR(ends.planes[0].normal.y(), -1, 1e-3);
  EXPECT_NEAR(ends.planes[0].offset, 60, 4);
  int unscanned = 0;
  for (std::size_t i = 0; i < head.filled.size(); ++i)
    unscanned += ends.no_scan[i] != head.filled[i];
  EXPECT_EQ(unscanned, 0);
}

}  // namespace
}  // namespace palpate::registration
