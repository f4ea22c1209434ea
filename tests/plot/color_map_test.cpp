// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot/color_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate::plot {
namespace {

double linear(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
struct Lab {
  double l, a, b;
};
/// sRGB to Oklab (Ottosson 2020), the inverse of what the map is made with.
Lab oklab(const Rgb& c) {
  const double r = linear(c.r), g = linear(c.g), b = linear(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

TEST(SequentialColor, EqualStepsLookEqual) {
  double least = 1, most = 0;
  for (int i = 0; i < 20; ++i) {
    const Lab a = oklab(sequential_color(i / 20.0)), b = oklab(sequential_color((i + 1) / 20.0));
    const double step = std::hypot(a.l - b.l, a.a - b.a, a.b - b.b);
    least = std::min(least, step);
    most = std::max(most, step);
  }
  EXPECT_LT(most / least, 1.15);
}

TEST(SequentialColor, LightnessRisesAllTheWay) {
  for (int i = 0; i < 100; ++i)
    EXPECT_LT(oklab(sequential_color(i / 100.0)).l, oklab(sequential_color((i + 1) / 100.0)).l);
  EXPECT_GT(oklab(sequential_color(1)).l - oklab(sequential_color(0)).l, 0.55);
}

TEST(SequentialColor, ClampsAndMarksMissing) {
  EXPECT_EQ(hex(sequential_color(-3)), hex(sequential_color(0)));
  EXPECT_EQ(hex(sequential_color(7)), hex(sequential_color(1)));
  EXPECT_EQ(hex(sequential_color(NAN)), hex(missing_color()));
}

TEST(CategoryColor, EightThatDiffer) {
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Lab a = oklab(category_color(i)), b = oklab(category_color(j));
      EXPECT_GT(std::hypot(a.l - b.l, a.a - b.a, a.b - b.b), 0.08) << i << " " << j;
    }
  EXPECT_EQ(hex(category_color(8)), hex(category_color(0)));
}

TEST(Hex, RoundsToBytes) {
  EXPECT_EQ(hex({0, 0.5, 1}), "#0080ff");
  EXPECT_EQ(hex({-1, 2, 0}), "#00ff00");
}

}  // namespace
}  // namespace palpate::plot
