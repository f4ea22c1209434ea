// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "plot/comparisons.hpp"
#include "plot/extent.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kText = 12.5;        ///< [px]
constexpr double kLegendRow = 22;     ///< [px]
constexpr double kGroupFill = 0.74;   ///< [-] of a group's room that its columns take
constexpr double kWidestColumn = 46;  ///< [px]
constexpr double kCap = 4;            ///< [px] half width of an error bar's ends

std::string color_of(const ColumnChart& chart, std::size_t s) {
  return chart.series[s].color.empty() ? hex(category_color(s)) : chart.series[s].color;
}

void draw_legend(SvgWriter& out, const ColumnChart& chart, double left, double y) {
  double x = left;
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    out.rectangle({x, y - 10}, 13, 11, color_of(chart, s));
    out.text({x + 18, y}, chart.series[s].label, {.size = kText});
    x += 18 + text_width(chart.series[s].label, kText) + 20;
  }
}

/// Gives the y [px] above which a mark may stand.
double draw_column(SvgWriter& out, const Frame& f, const Column& c, double base, double x,
                   double width, const std::string& color) {
  double top = f.y.at(base);
  if (!std::isfinite(c.value)) return top;
  const double from = f.y.at(base), to = f.y.at(c.value);
  out.rectangle({x, std::min(from, to)}, width, std::abs(to - from), color);
  top = std::min(top, to);
  if (!std::isfinite(c.low) || !std::isfinite(c.high) || c.low == c.high) return top;
  const double middle = x + 0.5 * width, low = f.y.at(c.low), high = f.y.at(c.high);
  const StrokeStyle ink{"currentColor", 1.4, 1, ""};
  out.line({middle, low}, {middle, high}, ink);
  for (const double end : {low, high}) out.line({middle - kCap, end}, {middle + kCap, end}, ink);
  return std::min(top, high);
}

void draw_group(SvgWriter& out, const Frame& f, const ColumnChart& chart, const ColumnGroup& group,
                double left, double room) {
  const auto count = static_cast<double>(std::max<std::size_t>(1, chart.series.size()));
  const double width = std::min(kWidestColumn, kGroupFill * room / count);
  const double middle = left + 0.5 * room;
  double x = middle - 0.5 * width * count, top = f.y.at(chart.base);
  for (std::size_t s = 0; s < group.columns.size(); ++s, x += width)
    top = std::min(top, draw_column(out, f, group.columns[s], chart.base, x + 1, width - 2,
                                    color_of(chart, s)));
  out.text({middle, f.bottom + 18}, group.label, {.size = kText, .anchor = Anchor::middle});
  if (!group.mark.empty())
    out.text({middle, top - 7}, group.mark,
             {.size = kText - 1.5, .anchor = Anchor::middle, .opacity = 0.85});
}

}  // namespace

std::string svg(const ColumnChart& chart) {
  Extent y;
  y.add(chart.base);
  for (const ColumnGroup& g : chart.groups) {
    if (g.columns.size() > chart.series.size())
      throw InputError(fmt::format("group '{}' has {} columns, the chart {} series", g.label,
                                   g.columns.size(), chart.series.size()));
    for (const Column& c : g.columns)
      for (const double v : {c.value, c.low, c.high}) y.add(v);
  }
  const double title = chart.title.empty() ? 12 : 36;
  const double legend = chart.series.size() > 1 ? kLegendRow : 0;
  Frame f{58, chart.width - 16, title + legend + 12, chart.height - 34, {}, {}};
  f.y = Scale(linear_ticks(y.low, y.high, 6), f.bottom, f.top);
  SvgWriter out(chart.width, chart.height, chart.title);
  draw_upright_axis(out, f, chart.title, chart.y_label);
  if (legend > 0) draw_legend(out, chart, f.left, title + 6);
  const double room =
      (f.right - f.left) / static_cast<double>(std::max<std::size_t>(1, chart.groups.size()));
  double left = f.left;
  for (const ColumnGroup& g : chart.groups) {
    draw_group(out, f, chart, g, left, room);
    left += room;
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
