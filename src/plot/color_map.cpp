// SPDX-License-Identifier: GPL-3.0-or-later
// The sequential map is computed, not copied: a path through Oklab whose lightness is linear in the
// parameter and whose hue turns from violet-blue to yellow, with the chroma that sRGB allows, then
// walked at constant perceived speed (arc length in Oklab).
#include "plot/color_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpate::plot {
namespace {

struct Lab {
  double l, a, b;
};

double encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// Linear sRGB of an Oklab colour; may lie outside [0, 1].
std::array<double, 3> linear_rgb(const Lab& c) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(c.l + 0.3963377774 * c.a + 0.2158037573 * c.b);
  const double m = cube(c.l - 0.1055613458 * c.a - 0.0638541728 * c.b);
  const double s = cube(c.l - 0.0894841775 * c.a - 1.2914855480 * c.b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool in_gamut(const Lab& c) {
  const auto rgb = linear_rgb(c);
  return std::all_of(rgb.begin(), rgb.end(), [](double x) { return x >= 0 && x <= 1; });
}

// The path. Changing these changes the look of every map; both ends must stay apart in lightness.
constexpr double kDark = 0.30, kLight = 0.92;      ///< [-] Oklab lightness
constexpr double kFirstHue = 292, kLastHue = 104;  ///< [deg] violet-blue, yellow
constexpr double kMostChroma = 0.15;               ///< [-] more looks like neon
constexpr double kGamutShare = 0.94;               ///< [-] stay clear of the gamut's edge
constexpr int kSteps = 256;

Lab on_path(double s) {
  const double l = kDark + (kLight - kDark) * s;
  const double hue = (kFirstHue + (kLastHue - kFirstHue) * s) * std::numbers::pi / 180;
  const double ca = std::cos(hue), sa = std::sin(hue);
  double low = 0, high = kMostChroma / kGamutShare;  // largest chroma in the gamut by bisection
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (in_gamut({l, middle * ca, middle * sa}) ? low : high) = middle;
  }
  return {l, kGamutShare * low * ca, kGamutShare * low * sa};
}

std::array<Rgb, kSteps> make_table() {
  constexpr int kFine = 2048;
  std::array<double, kFine + 1> length{};
  Lab last = on_path(0);
  for (int i = 1; i <= kFine; ++i) {
    const Lab c = on_path(static_cast<double>(i) / kFine);
    length[i] = length[i - 1] + std::hypot(c.l - last.l, c.a - last.a, c.b - last.b);
    last = c;
  }
  std::array<Rgb, kSteps> table;
  int i = 0;
  for (int k = 0; k < kSteps; ++k) {
    const double at = length[kFine] * k / (kSteps - 1);
    while (i < kFine - 1 && length[i + 1] < at) ++i;
    const double part = (at - length[i]) / (length[i + 1] - length[i]);
    const auto rgb = linear_rgb(on_path((i + part) / kFine));
    const auto value = [](double x) { return std::clamp(encode(std::max(0.0, x)), 0.0, 1.0); };
    table[k] = {value(rgb[0]), value(rgb[1]), value(rgb[2])};
  }
  return table;
}

}  // namespace

std::string hex(const Rgb& c) {
  const auto byte = [](double x) {
    return static_cast<int>(std::lround(255 * std::clamp(x, 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

Rgb sequential_color(double t) {
  static const std::array<Rgb, kSteps> table = make_table();
  if (std::isnan(t)) return missing_color();
  const double at = std::clamp(t, 0.0, 1.0) * (kSteps - 1);
  const int i = std::min(kSteps - 2, static_cast<int>(at));
  const double w = at - i;
  const Rgb &a = table[i], &b = table[i + 1];
  return {a.r + w * (b.r - a.r), a.g + w * (b.g - a.g), a.b + w * (b.b - a.b)};
}

Rgb missing_color() {
  return {0.74, 0.74, 0.73};
}

Rgb category_color(std::size_t index) {
  static constexpr std::array<Rgb, 8> kColors = {{{0x44 / 255.0, 0x77 / 255.0, 0xAA / 255.0},
                                                  {0xEE / 255.0, 0x66 / 255.0, 0x77 / 255.0},
                                                  {0x22 / 255.0, 0x88 / 255.0, 0x33 / 255.0},
                                                  {0xCC / 255.0, 0xBB / 255.0, 0x44 / 255.0},
                                                  {0x66 / 255.0, 0xCC / 255.0, 0xEE / 255.0},
                                                  {0xAA / 255.0, 0x33 / 255.0, 0x77 / 255.0},
                                                  {0xE0 / 255.0, 0x8A / 255.0, 0x2E / 255.0},
                                                  {0x8A / 255.0, 0x8F / 255.0, 0x94 / 255.0}}};
  return kColors[index % kColors.size()];
}

}  // namespace palpate::plot
