// SPDX-License-Identifier: GPL-3.0-or-later
// Figures made of rows: horizontal bars and ranges.
#include <algorithm>
#include <cmath>

#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kRow = 26;      ///< [px] of a bar
constexpr double kSlimRow = 20;  ///< [px] of a range
constexpr double kText = 12.5;   ///< [px]
constexpr double kAxisRoom = 46;
constexpr std::string_view kCalm = "#2f7fb8", kWarn = "#d9622b";

template <class Rows>
double label_width(const Rows& rows) {
  double width = 0;
  for (const auto& r : rows) width = std::max(width, text_width(r.label, kText));
  return width;
}

}  // namespace

std::string svg(const BarChart& chart) {
  double low = 0, high = 0, after = 0;
  for (const Bar& b : chart.bars) {
    if (std::isfinite(b.value)) low = std::min(low, b.value), high = std::max(high, b.value);
    after = std::max(after, text_width(number_text(b.value, 3) + "  " + b.note, kText));
  }
  Frame f;
  f.left = label_width(chart.bars) + 18;
  f.right = std::max(f.left + 80, chart.width - after - 16);
  f.top = chart.title.empty() ? 8 : 34;
  f.bottom = f.top + kRow * static_cast<double>(chart.bars.size());
  f.x = Scale(linear_ticks(low, high, 6), f.left, f.right);
  SvgWriter out(chart.width, f.bottom + kAxisRoom, chart.title);
  draw_value_axis(out, f, chart.title, chart.value_label);
  double y = f.top;
  for (const Bar& b : chart.bars) {
    const double middle = y + 0.5 * kRow;
    out.text({f.left - 8, middle + 4}, b.label, {.size = kText, .anchor = Anchor::end});
    double end = f.x.at(0);
    std::string value = "no value";
    if (std::isfinite(b.value)) {
      const double zero = end;
      end = f.x.at(b.value);
      out.rectangle({std::min(zero, end), y + 4}, std::abs(end - zero), kRow - 8,
                    b.color.empty() ? hex(category_color(0)) : b.color);
      value = number_text(b.value, 3);
    }
    const double at = std::max(end, f.x.at(0)) + 6;
    out.text({at, middle + 4}, value, {.size = kText});
    if (!b.note.empty())
      out.text({at + text_width(value, kText) + 8, middle + 4}, b.note,
               {.size = kText - 1, .opacity = 0.65});
    y += kRow;
  }
  return std::move(out).finish();
}

static void draw_range_legend(SvgWriter& out, const RangePlot& plot, double left, double y) {
  out.rectangle({left, y - 8}, 26, 9, "currentColor", 0.18);
  out.text({left + 32, y}, plot.band_name, {.size = kText - 0.5});
  const double next = left + 32 + text_width(plot.band_name, kText) + 22;
  out.circle({next, y - 4}, 4.5, kCalm);
  out.circle({next + 12, y - 4}, 4.5, kWarn);
  out.text({next + 22, y}, plot.value_name, {.size = kText - 0.5});
}

std::string svg(const RangePlot& plot) {
  double low = 0, high = 0;
  for (const Range& r : plot.rows)
    for (const double v : {r.low, r.high, r.middle, r.value})
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  Frame f;
  f.left = label_width(plot.rows) + 18;
  f.right = plot.width - 24;
  f.top = plot.title.empty() ? 32 : 58;
  f.bottom = f.top + kSlimRow * static_cast<double>(plot.rows.size());
  f.x = Scale(linear_ticks(low, high, 8), f.left, f.right);
  SvgWriter out(plot.width, f.bottom + kAxisRoom, plot.title);
  draw_value_axis(out, f, plot.title, plot.value_label);
  draw_range_legend(out, plot, f.left, f.top - 12);
  double y = f.top;
  for (const Range& r : plot.rows) {
    const double middle = y + 0.5 * kSlimRow;
    out.text({f.left - 8, middle + 4}, r.label, {.size = kText - 0.5, .anchor = Anchor::end});
    if (r.high > r.low)
      out.rectangle({f.x.at(r.low), middle - 4.5}, f.x.at(r.high) - f.x.at(r.low), 9,
                    "currentColor", 0.18);
    if (std::isfinite(r.middle))
      out.line({f.x.at(r.middle), middle - 6}, {f.x.at(r.middle), middle + 6},
               {"currentColor", 1.5, 0.6, ""});
    if (std::isfinite(r.value))
      out.circle({f.x.at(r.value), middle}, 4.5, r.inside ? kCalm : kWarn);
    y += kSlimRow;
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
