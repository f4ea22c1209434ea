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

constexpr double kText = 12.5;   ///< [px]
constexpr double kRadius = 4;    ///< [px] of a dot of weight 1
constexpr double kSmallest = 2;  ///< [px]

void draw_curve(SvgWriter& out, const Frame& f, const Series& s, const std::string& color) {
  std::vector<PixelPoint> run;
  PixelPoint last{};
  bool any = false;
  const auto flush = [&] {
    out.polyline(run, {color, 2, 1, s.dash});
    run.clear();
  };
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) {
      flush();
      continue;
    }
    run.push_back(last = {f.x.at(s.x[i]), f.y.at(s.y[i])});
    any = true;
  }
  flush();
  if (any && !s.name.empty())
    out.text({f.right + 8, last.y + 4}, s.name, {.size = kText, .fill = color});
}

void draw_dot(SvgWriter& out, const Frame& f, const Dot& d, const std::string& color) {
  if (!std::isfinite(d.x) || !std::isfinite(d.y)) return;
  const PixelPoint at{f.x.at(d.x), f.y.at(d.y)};
  if (std::isfinite(d.low) && std::isfinite(d.high) && d.low < d.high) {
    const StrokeStyle ink{"currentColor", 1.1, 0.6, ""};
    out.line({at.x, f.y.at(d.low)}, {at.x, f.y.at(d.high)}, ink);
    for (const double end : {d.low, d.high})
      out.line({at.x - 3, f.y.at(end)}, {at.x + 3, f.y.at(end)}, ink);
  }
  const double radius = std::max(kSmallest, kRadius * std::sqrt(std::max(0.0, d.weight)));
  out.circle(at, radius, color, 0.9);
  if (!d.label.empty()) out.text({at.x + radius + 5, at.y + 4}, d.label, {.size = kText - 0.5});
}

void check_lengths(const Series& s) {
  if (s.x.size() != s.y.size())
    throw InputError(fmt::format("curve '{}' has {} x and {} y", s.name, s.x.size(), s.y.size()));
}

}  // namespace

std::string svg(const DotPlot& plot) {
  Extent x, y;
  double names = 0;
  for (const Dot& d : plot.dots) {
    x.add(d.x);
    for (const double v : {d.y, d.low < d.high ? d.low : d.y, d.low < d.high ? d.high : d.y})
      y.add(v);
  }
  for (const Series& s : plot.curves) {
    check_lengths(s);
    for (const double v : s.x) x.add(v);
    for (const double v : s.y) y.add(v);
    names = std::max(names, text_width(s.name, kText));
  }
  if (plot.x_from_zero) x.add(0);
  if (plot.y_from_zero) y.add(0);
  if (plot.y_least < plot.y_most) y.add(plot.y_least), y.add(plot.y_most);
  for (const Dot& d : plot.dots) names = std::max(names, 0.5 * text_width(d.label, kText));
  Frame f{58, plot.width - names - 24, plot.title.empty() ? 14.0 : 40.0, plot.height - 48, {}, {}};
  f.x = Scale(linear_ticks(x.low, x.high, 8), f.left, f.right);
  f.y = Scale(linear_ticks(y.low, y.high, 6), f.bottom, f.top);
  SvgWriter out(plot.width, plot.height, plot.title);
  draw_axes(out, f, plot.title, plot.x_label, plot.y_label);
  for (std::size_t i = 0; i < plot.curves.size(); ++i)
    draw_curve(out, f, plot.curves[i],
               plot.curves[i].color.empty() ? hex(category_color(i + 1)) : plot.curves[i].color);
  const std::string color = plot.dot_color.empty() ? hex(category_color(0)) : plot.dot_color;
  for (const Dot& d : plot.dots) draw_dot(out, f, d, color);
  if (!plot.note.empty()) out.text({f.left + 12, f.top + 16}, plot.note, {.size = kText});
  return std::move(out).finish();
}

}  // namespace palpate::plot
