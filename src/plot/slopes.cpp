// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "plot/comparisons.hpp"
#include "plot/extent.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kText = 12.5;   ///< [px]
constexpr double kInset = 0.22;  ///< [-] of a panel's room, from its side to its values
constexpr double kGap = 6;       ///< [px] between panels

void draw_panel(SvgWriter& out, const Frame& f, const SlopePlot& plot, const SlopePanel& panel,
                double left, double room) {
  const double x0 = left + kInset * room, x1 = left + (1 - kInset) * room;
  const std::string calm = hex(category_color(0)), strong = hex(category_color(1));
  double sum0 = 0, sum1 = 0, n = 0;
  for (const SlopePair& p : panel.pairs) {
    if (!std::isfinite(p.left) || !std::isfinite(p.right)) continue;
    out.line({x0, f.y.at(p.left)}, {x1, f.y.at(p.right)}, {calm, 1, 0.5, ""});
    sum0 += p.left, sum1 += p.right, n += 1;
  }
  for (const double x : {x0, x1})
    out.line({x, f.top}, {x, f.bottom}, {"currentColor", 1, 0.25, ""});
  if (n > 0) {
    const PixelPoint a{x0, f.y.at(sum0 / n)}, b{x1, f.y.at(sum1 / n)};
    out.line(a, b, {strong, 3, 1, ""});
    out.circle(a, 4.2, strong);
    out.circle(b, 4.2, strong);
  }
  const TextStyle small{.size = kText - 2, .anchor = Anchor::middle, .opacity = 0.8};
  out.text({x0, f.bottom + 15}, plot.left_name, small);
  out.text({x1, f.bottom + 15}, plot.right_name, small);
  out.text({0.5 * (x0 + x1), f.top - 22}, panel.label,
           {.size = kText, .anchor = Anchor::middle, .bold = true});
  out.text({0.5 * (x0 + x1), f.top - 8}, panel.mark, small);
}

}  // namespace

std::string svg(const SlopePlot& plot) {
  Extent y;
  for (const SlopePanel& panel : plot.panels)
    for (const SlopePair& p : panel.pairs) y.add(p.left), y.add(p.right);
  Frame f{58, plot.width - 8, (plot.title.empty() ? 10.0 : 36.0) + 34, plot.height - 28, {}, {}};
  f.y = Scale(linear_ticks(y.low, y.high, 6), f.bottom, f.top);
  SvgWriter out(plot.width, plot.height, plot.title);
  draw_upright_axis(out, f, plot.title, plot.y_label);
  const double room =
      (f.right - f.left) / static_cast<double>(std::max<std::size_t>(1, plot.panels.size()));
  double left = f.left;
  for (const SlopePanel& panel : plot.panels) {
    draw_panel(out, f, plot, panel, left + 0.5 * kGap, room - kGap);
    left += room;
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
