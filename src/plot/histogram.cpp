// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {

std::string svg(const Histogram& h) {
  if (h.bins < 1) throw InputError("a histogram needs at least one bin");
  double low = h.low, high = h.high;
  if (low == high) {
    low = INFINITY, high = -INFINITY;
    for (const double v : h.values)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (!(high > low)) low = std::isfinite(low) ? low : 0, high = low + 1;
  }
  std::vector<double> count(h.bins, 0);
  for (const double v : h.values)
    if (std::isfinite(v)) {
      const double at = (v - low) / (high - low) * h.bins;
      ++count[static_cast<std::size_t>(std::clamp(at, 0.0, h.bins - 1.0))];
    }
  Frame f;
  f.left = 64;
  f.right = h.width - 20;
  f.top = h.title.empty() ? 14 : 40;
  f.bottom = h.height - 48;
  f.x = Scale(linear_ticks(low, high, 8), f.left, f.right);
  f.y = Scale(linear_ticks(0, std::max(1.0, *std::max_element(count.begin(), count.end())), 4),
              f.bottom, f.top);
  SvgWriter out(h.width, h.height, h.title);
  draw_axes(out, f, h.title, h.x_label, h.y_label);
  for (int b = 0; b < h.bins; ++b) {
    if (count[b] == 0) continue;
    const double x0 = f.x.at(low + (high - low) * b / h.bins);
    const double x1 = f.x.at(low + (high - low) * (b + 1) / h.bins);
    const double y = f.y.at(count[b]);
    out.rectangle({x0 + 0.5, y}, std::max(0.5, x1 - x0 - 1), f.bottom - y, hex(category_color(0)));
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
