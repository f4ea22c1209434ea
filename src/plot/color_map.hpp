// SPDX-License-Identifier: GPL-3.0-or-later
// Colours that carry numbers, and colours that tell things apart.
#pragma once
#include <cstddef>
#include <string>

namespace palpate::plot {

struct Rgb {
  double r = 0, g = 0, b = 0;  ///< [-] sRGB, 0 to 1
};

/// "#rrggbb", components rounded to 8 bits.
[[nodiscard]] std::string hex(const Rgb& color);

/// Sequential map for t in [0, 1] (clamped; NaN gives the grey of missing values): dark violet-blue
/// over teal to light yellow. Lightness rises in even steps, so that it reads in grey and for every
/// common colour blindness; equal steps of t are equal steps of perceived colour.
/// @cite Ottosson 2020, "A perceptual color space for image processing" (Oklab)
[[nodiscard]] Rgb sequential_color(double t);

/// What a value without a number is painted with.
[[nodiscard]] Rgb missing_color();

/// Distinct colours for categories, index taken modulo 8; safe for common colour blindness and
/// legible on white and on black.
/// @cite Paul Tol 2021, "Colour schemes", the bright scheme, and one more
[[nodiscard]] Rgb category_color(std::size_t index);

}  // namespace palpate::plot
