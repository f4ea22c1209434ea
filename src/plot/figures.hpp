// SPDX-License-Identifier: GPL-3.0-or-later
// Figures as SVG text: curves, bars, histograms, ranges, colour legends. Each is a value that is
// filled and handed to svg(). The same value gives the same bytes. Text is escaped. Axes and text
// take the page's ink (CSS variable --ink, else near black), so that a figure prints and follows a
// dark page.
#pragma once
#include <string>
#include <vector>

namespace palpate::plot {

struct Series {
  std::string name{};
  std::vector<double> x{}, y{};  ///< as long as each other; a NaN breaks the line
  std::string color{};           ///< "#rrggbb"; "" takes the next category colour
  std::string dash{};            ///< SVG dash array; "" is solid
  bool markers = true;           ///< a dot at every sample
};
/// Curves with their names at their right ends.
struct LinePlot {
  std::string title{}, x_label{}, y_label{};
  std::vector<Series> series{};
  bool include_zero = true;  ///< both axes start at 0 or below
  double width = 760, height = 420;
};

struct Bar {
  std::string label{};
  double value = 0;     ///< NaN: no bar, the text "no value"
  std::string color{};  ///< "" takes the first category colour
  std::string note{};   ///< after the value, in lighter ink
};
/// Horizontal bars from 0, first on top, each with its value.
struct BarChart {
  std::string title{}, value_label{};
  std::vector<Bar> bars{};
  double width = 760;
};

struct Histogram {
  std::string title{}, x_label{}, y_label = "count";
  std::vector<double> values{};  ///< NaN are left out
  int bins = 24;
  double low = 0, high = 0;  ///< low == high: from the values; values beyond go to the last bin
  double width = 760, height = 260;
};

struct Range {
  std::string label{};
  double low = 0, high = 0;  ///< the expected span; low == high draws a mark only
  double middle = 0;         ///< the expected value
  double value = 0;          ///< what was found; NaN draws no dot
  bool inside = true;        ///< paints the dot calm, else as a warning
};
/// One row per quantity: the expected span as a band, what was found as a dot.
struct RangePlot {
  std::string title{}, value_label{};
  std::string band_name{}, value_name{};  ///< for the legend
  std::vector<Range> rows{};
  double width = 760;
};

/// The bar that says what the colours of a heat map mean.
struct ColorLegend {
  std::string label{};  ///< quantity and unit
  double low = 0, high = 1;
  bool logarithmic = false;
  std::string missing{};  ///< what the grey means; "" leaves the grey out
  double width = 420;
};

struct Swatch {
  std::string label{}, color{};
};
/// Colours that stand for categories, in rows.
struct CategoryLegend {
  std::vector<Swatch> entries{};
  double width = 760;
};

/// @throws InputError  x and y of a series differ in length
[[nodiscard]] std::string svg(const LinePlot& plot);
[[nodiscard]] std::string svg(const BarChart& chart);
/// @throws InputError  bins < 1
[[nodiscard]] std::string svg(const Histogram& histogram);
[[nodiscard]] std::string svg(const RangePlot& plot);
/// @throws InputError  low >= high, or low <= 0 on a logarithmic scale
[[nodiscard]] std::string svg(const ColorLegend& legend);
[[nodiscard]] std::string svg(const CategoryLegend& legend);

}  // namespace palpate::plot
