// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "plot/extent.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kLabelSize = 12.5;  ///< [px] names at the ends of the curves
constexpr double kLabelGap = 16;     ///< [px] smallest distance between two names

/// Runs of finite points, in pixels.
std::vector<std::vector<PixelPoint>> runs(const Series& s, const Frame& frame) {
  std::vector<std::vector<PixelPoint>> out(1);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (std::isfinite(s.x[i]) && std::isfinite(s.y[i]))
      out.back().push_back({frame.x.at(s.x[i]), frame.y.at(s.y[i])});
    else if (!out.back().empty())
      out.emplace_back();
  }
  if (out.back().empty()) out.pop_back();
  return out;
}

struct EndLabel {
  std::size_t series;
  PixelPoint end;
  double y;  ///< where the name goes
};

/// Pushes names apart downwards, then back up where they fell below the frame.
void spread(std::vector<EndLabel>& labels, double bottom) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const EndLabel& a, const EndLabel& b) { return a.end.y < b.end.y; });
  for (std::size_t i = 1; i < labels.size(); ++i)
    labels[i].y = std::max(labels[i].y, labels[i - 1].y + kLabelGap);
  double limit = bottom;
  for (std::size_t i = labels.size(); i-- > 0; limit = labels[i].y - kLabelGap)
    labels[i].y = std::min(labels[i].y, limit);
}

}  // namespace

std::string svg(const LinePlot& plot) {
  Extent x, y;
  double names = 0;
  for (const Series& s : plot.series) {
    if (s.x.size() != s.y.size())
      throw InputError(
          fmt::format("series '{}' has {} x and {} y", s.name, s.x.size(), s.y.size()));
    for (const double v : s.x) x.add(v);
    for (const double v : s.y) y.add(v);
    names = std::max(names, text_width(s.name, kLabelSize));
  }
  if (plot.include_zero) x.add(0), y.add(0);
  Frame frame;
  frame.left = 58;
  frame.top = plot.title.empty() ? 14 : 40;
  frame.right = plot.width - names - 34;
  frame.bottom = plot.height - 48;
  frame.x = Scale(linear_ticks(x.low, x.high, 8), frame.left, frame.right);
  frame.y = Scale(linear_ticks(y.low, y.high, 6), frame.bottom, frame.top);

  SvgWriter out(plot.width, plot.height, plot.title);
  draw_axes(out, frame, plot.title, plot.x_label, plot.y_label);
  std::vector<EndLabel> labels;
  std::vector<std::string> colors;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& s = plot.series[i];
    colors.push_back(s.color.empty() ? hex(category_color(i)) : s.color);
    const auto parts = runs(s, frame);
    for (const auto& part : parts) {
      out.polyline(part, {colors[i], 2, 1, s.dash});
      if (s.markers)
        for (const PixelPoint& p : part) out.circle(p, 2.6, colors[i]);
    }
    if (!parts.empty() && !s.name.empty())
      labels.push_back({i, parts.back().back(), parts.back().back().y});
  }
  spread(labels, frame.bottom);
  for (const EndLabel& label : labels) {
    const double from = frame.right + 6;
    out.line({std::max(label.end.x + 4, frame.right - 1), label.end.y}, {from + 12, label.y},
             {colors[label.series], 1, 0.7, ""});
    out.text({from + 16, label.y + 4}, plot.series[label.series].name, {kLabelSize});
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
