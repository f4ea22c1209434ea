// SPDX-License-Identifier: GPL-3.0-or-later
// Figures that compare measured people: groups of columns with error bars, every value beside its
// box, pairs joined by lines, points with a fitted line or a model's curve. As in figures.hpp: a
// value is filled and handed to svg(); the same value gives the same bytes; NaN is left out. In
// print without colour the groups still differ by dash and by lightness.
#pragma once
#include <string>
#include <vector>

#include "plot/figures.hpp"

namespace palpate::plot {

struct Column {
  double value = 0;          ///< NaN: no column
  double low = 0, high = 0;  ///< ends of the error bar; NaN: none
};
struct ColumnGroup {
  std::string label{};
  std::vector<Column> columns{};  ///< one per series; fewer leave the rest empty
  std::string mark{};             ///< above the group, for example "p = 0.01"
};
/// Upright columns from `base`, grouped along x; one colour per series.
struct ColumnChart {
  std::string title{}, y_label{};
  std::vector<Swatch> series{};  ///< names of the columns; color "" takes the next category colour
  std::vector<ColumnGroup> groups{};
  double base = 0;
  double width = 760, height = 360;
};

struct Strip {
  std::string label{};
  std::vector<double> values{};
  std::string color{};  ///< "" takes the next category colour
};
/// Every value as a dot beside the box of its quartiles (whiskers to the farthest value within 1.5
/// box heights; Tukey 1977). Equal values are set side by side, so that none hides another.
struct StripPlot {
  std::string title{}, y_label{};
  std::vector<Strip> strips{};
  double reference = 0;  ///< a dashed line across; drawn where its name is not empty
  std::string reference_name{};
  double width = 760, height = 360;
};

struct SlopePair {
  double left = 0, right = 0;
};
struct SlopePanel {
  std::string label{};
  std::vector<SlopePair> pairs{};  ///< one per person; a pair with a NaN is left out
  std::string mark{};              ///< under the label
};
/// One panel per quantity: each person's two values joined by a line, the means by a thick one.
struct SlopePlot {
  std::string title{}, y_label{}, left_name{}, right_name{};
  std::vector<SlopePanel> panels{};
  double width = 760, height = 340;
};

struct Dot {
  double x = 0, y = 0;
  double low = 0, high = 0;  ///< ends of the error bar; equal or NaN: none
  double weight = 1;         ///< area of the dot in units of the ordinary one
  std::string label{};       ///< beside the dot
};
/// Points with curves through them: a scatter with its line, a psychometric function with its data.
struct DotPlot {
  std::string title{}, x_label{}, y_label{};
  std::vector<Dot> dots{};
  std::string dot_color{};
  std::vector<Series> curves{};  ///< drawn without markers; named at their right ends
  bool x_from_zero = false, y_from_zero = false;
  double y_least = 0, y_most = 0;  ///< least < most: the axis covers these too
  std::string note{};              ///< in the upper left corner
  double width = 760, height = 380;
};

/// @throws InputError  a group has more columns than there are series
[[nodiscard]] std::string svg(const ColumnChart& chart);
[[nodiscard]] std::string svg(const StripPlot& plot);
[[nodiscard]] std::string svg(const SlopePlot& plot);
/// @throws InputError  x and y of a curve differ in length
[[nodiscard]] std::string svg(const DotPlot& plot);

}  // namespace palpate::plot
