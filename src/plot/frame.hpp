// SPDX-License-Identifier: GPL-3.0-or-later
// Axes shared by the figures.
#pragma once
#include <string_view>
#include <vector>

#include "plot/axis.hpp"
#include "plot/color_map.hpp"
#include "plot/figures.hpp"
#include "plot/svg_writer.hpp"

namespace palpate::plot {

/// Linear map of values to pixels; spans its ticks.
class Scale {
 public:
  Scale() = default;
  Scale(std::vector<Tick> ticks, double pixel_low, double pixel_high)
      : ticks_(std::move(ticks)), pixel_low_(pixel_low), pixel_high_(pixel_high) {}
  [[nodiscard]] double at(double value) const {
    const double low = ticks_.front().value, high = ticks_.back().value;
    return pixel_low_ + (value - low) / (high - low) * (pixel_high_ - pixel_low_);
  }
  [[nodiscard]] const std::vector<Tick>& ticks() const { return ticks_; }

 private:
  std::vector<Tick> ticks_ = {{0, "0"}, {1, "1"}};
  double pixel_low_ = 0, pixel_high_ = 1;
};

struct Frame {
  double left = 0, right = 0, top = 0, bottom = 0;  ///< [px]
  Scale x, y;
};

/// Grid, ticks, labels and title of an x-y figure.
void draw_axes(SvgWriter& out, const Frame& frame, std::string_view title, std::string_view x_label,
               std::string_view y_label);
/// Only the horizontal value axis of a figure made of rows: vertical grid lines, ticks and label.
void draw_value_axis(SvgWriter& out, const Frame& frame, std::string_view title,
                     std::string_view label);

/// Only the vertical value axis of a figure made of columns: horizontal grid lines, ticks and
/// label.
void draw_upright_axis(SvgWriter& out, const Frame& frame, std::string_view title,
                       std::string_view label);

}  // namespace palpate::plot
