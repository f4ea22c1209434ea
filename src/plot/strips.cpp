// SPDX-License-Identifier: GPL-3.0-or-later
// Tukey 1977, "Exploratory Data Analysis": boxes and whiskers. Dots of equal height are spread to
// both sides in turn, from the middle out.
#include <algorithm>
#include <cmath>
#include <map>

#include "plot/comparisons.hpp"
#include "plot/extent.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kText = 12.5;    ///< [px]
constexpr double kRadius = 3.2;   ///< [px] of a dot
constexpr double kDotGap = 7;     ///< [px] between the centres of equal values
constexpr double kBox = 0.16;     ///< [-] half width of the box, of a strip's room
constexpr double kDotsAt = 0.24;  ///< [-] where the dots' middle lies, right of the strip's middle
constexpr double kBoxAt = -0.18;

/// Linear interpolation between sorted values; they are not empty.
double quantile(const std::vector<double>& sorted, double q) {
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= sorted.size()) return sorted.back();
  return sorted[i] + (at - static_cast<double>(i)) * (sorted[i + 1] - sorted[i]);
}

void draw_box(SvgWriter& out, const Frame& f, const std::vector<double>& sorted, double x,
              double half, const std::string& color) {
  const double q1 = quantile(sorted, 0.25), q2 = quantile(sorted, 0.5), q3 = quantile(sorted, 0.75);
  const double reach = 1.5 * (q3 - q1);
  const double low = *std::lower_bound(sorted.begin(), sorted.end(), q1 - reach);
  const double high = *(std::upper_bound(sorted.begin(), sorted.end(), q3 + reach) - 1);
  const StrokeStyle ink{"currentColor", 1.2, 0.8, ""};
  out.line({x, f.y.at(low)}, {x, f.y.at(q1)}, ink);
  out.line({x, f.y.at(q3)}, {x, f.y.at(high)}, ink);
  for (const double end : {low, high})
    out.line({x - 0.5 * half, f.y.at(end)}, {x + 0.5 * half, f.y.at(end)}, ink);
  out.rectangle({x - half, f.y.at(q3)}, 2 * half, f.y.at(q1) - f.y.at(q3), color, 0.3);
  out.polyline({{x - half, f.y.at(q1)},
                {x + half, f.y.at(q1)},
                {x + half, f.y.at(q3)},
                {x - half, f.y.at(q3)},
                {x - half, f.y.at(q1)}},
               ink);
  out.line({x - half, f.y.at(q2)}, {x + half, f.y.at(q2)}, {"currentColor", 2.2, 1, ""});
}

void draw_dots(SvgWriter& out, const Frame& f, const std::vector<double>& sorted, double x,
               double room, const std::string& color) {
  std::map<double, std::size_t> count, placed;
  for (const double v : sorted) ++count[v];
  for (const double v : sorted) {
    const auto all = static_cast<double>(count[v]);
    const double gap = std::min(kDotGap, room / std::max(1.0, all));
    const auto k = static_cast<double>(placed[v]++);
    out.circle({x + gap * (k - 0.5 * (all - 1)), f.y.at(v)}, kRadius, color, 0.85);
  }
}

}  // namespace

std::string svg(const StripPlot& plot) {
  Extent y;
  for (const Strip& s : plot.strips)
    for (const double v : s.values) y.add(v);
  if (!plot.reference_name.empty()) y.add(plot.reference);
  Frame f{58, plot.width - 16, plot.title.empty() ? 14.0 : 42.0, plot.height - 34, {}, {}};
  if (!plot.reference_name.empty()) f.right -= text_width(plot.reference_name, kText) + 8;
  f.y = Scale(linear_ticks(y.low, y.high, 7), f.bottom, f.top);
  SvgWriter out(plot.width, plot.height, plot.title);
  draw_upright_axis(out, f, plot.title, plot.y_label);
  if (!plot.reference_name.empty() && std::isfinite(plot.reference)) {
    const double at = f.y.at(plot.reference);
    out.line({f.left, at}, {f.right, at}, {"currentColor", 1.3, 0.7, "5 4"});
    out.text({f.right + 8, at + 4}, plot.reference_name, {.size = kText});
  }
  const double room =
      (f.right - f.left) / static_cast<double>(std::max<std::size_t>(1, plot.strips.size()));
  for (std::size_t i = 0; i < plot.strips.size(); ++i) {
    const Strip& s = plot.strips[i];
    const double middle = f.left + room * (static_cast<double>(i) + 0.5);
    out.text({middle, f.bottom + 18}, s.label, {.size = kText, .anchor = Anchor::middle});
    std::vector<double> sorted;
    for (const double v : s.values)
      if (std::isfinite(v)) sorted.push_back(v);
    if (sorted.empty()) continue;
    std::sort(sorted.begin(), sorted.end());
    const std::string color = s.color.empty() ? hex(category_color(i)) : s.color;
    draw_box(out, f, sorted, middle + kBoxAt * room, std::min(26.0, kBox * room), color);
    draw_dots(out, f, sorted, middle + kDotsAt * room, 0.4 * room, color);
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
