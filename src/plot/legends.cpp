// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kText = 12;
constexpr double kBar = 14;  ///< [px] height of the colour bar
constexpr int kSteps = 64;

}  // namespace

std::string svg(const ColorLegend& legend) {
  if (!(legend.high > legend.low) || (legend.logarithmic && !(legend.low > 0)))
    throw InputError(fmt::format("legend '{}': range {} to {} cannot be drawn", legend.label,
                                 legend.low, legend.high));
  const auto part = [&](double v) {
    return legend.logarithmic ? std::log(v / legend.low) / std::log(legend.high / legend.low)
                              : (v - legend.low) / (legend.high - legend.low);
  };
  const double grey = legend.missing.empty() ? 0 : 34 + text_width(legend.missing, kText);
  const double left = 14, right = std::max(left + 100, legend.width - 14 - grey), top = 24;
  SvgWriter out(legend.width, top + kBar + 24, legend.label);
  out.text({left, 15}, legend.label, {.size = kText + 0.5, .bold = true});
  const double step = (right - left) / kSteps;
  for (int i = 0; i < kSteps; ++i)  // each piece runs to the end: no seams between them
    out.rectangle({left + i * step, top}, right - left - i * step, kBar,
                  hex(sequential_color((i + 0.5) / kSteps)));
  const auto ticks = legend.logarithmic ? log_ticks(legend.low, legend.high)
                                        : linear_ticks(legend.low, legend.high, 5);
  for (const Tick& t : ticks) {
    const double at = part(t.value);
    if (at < -1e-9 || at > 1 + 1e-9) continue;
    const double x = left + at * (right - left);
    out.line({x, top + kBar}, {x, top + kBar + 4}, {"currentColor", 1, 0.6, ""});
    out.text({x, top + kBar + 17}, t.text, {.size = kText - 0.5, .anchor = Anchor::middle});
  }
  if (grey > 0) {
    out.rectangle({right + 16, top}, kBar, kBar, hex(missing_color()));
    out.text({right + 22 + kBar, top + 11}, legend.missing, {.size = kText});
  }
  return std::move(out).finish();
}

std::string svg(const CategoryLegend& legend) {
  constexpr double kRow = 22;
  double widest = 0;
  for (const Swatch& s : legend.entries) widest = std::max(widest, text_width(s.label, kText));
  const double column = widest + 44;
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>(legend.width / column));
  const std::size_t rows = (legend.entries.size() + columns - 1) / columns;
  SvgWriter out(legend.width, kRow * static_cast<double>(std::max<std::size_t>(1, rows)) + 4, "");
  for (std::size_t i = 0; i < legend.entries.size(); ++i) {
    const double x = 8 + column * static_cast<double>(i % columns);
    const double y = kRow * static_cast<double>(i / columns) + 4;
    out.rectangle({x, y}, 14, 14, legend.entries[i].color);
    out.text({x + 20, y + 11.5}, legend.entries[i].label, {.size = kText});
  }
  return std::move(out).finish();
}

}  // namespace palpate::plot
