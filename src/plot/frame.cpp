// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot/frame.hpp"

namespace palpate::plot {
namespace {

constexpr double kTick = 11.5, kLabel = 12.5, kTitle = 14;  ///< [px] type sizes
const StrokeStyle kGrid{"currentColor", 1, 0.13, ""};
const StrokeStyle kAxis{"currentColor", 1, 0.55, ""};

void draw_title(SvgWriter& out, const Frame& f, std::string_view title) {
  if (!title.empty()) out.text({f.left, 20}, title, {.size = kTitle, .bold = true});
}

}  // namespace

void draw_value_axis(SvgWriter& out, const Frame& f, std::string_view title,
                     std::string_view label) {
  draw_title(out, f, title);
  for (const Tick& t : f.x.ticks()) {
    const double x = f.x.at(t.value);
    out.line({x, f.top}, {x, f.bottom}, kGrid);
    out.text({x, f.bottom + 16}, t.text, {.size = kTick, .anchor = Anchor::middle, .opacity = 0.8});
  }
  out.text({0.5 * (f.left + f.right), f.bottom + 36}, label,
           {.size = kLabel, .anchor = Anchor::middle});
}

void draw_upright_axis(SvgWriter& out, const Frame& f, std::string_view title,
                       std::string_view label) {
  draw_title(out, f, title);
  for (const Tick& t : f.y.ticks()) {
    const double y = f.y.at(t.value);
    out.line({f.left, y}, {f.right, y}, kGrid);
    out.text({f.left - 8, y + 4}, t.text, {.size = kTick, .anchor = Anchor::end, .opacity = 0.8});
  }
  out.line({f.left, f.bottom}, {f.right, f.bottom}, kAxis);
  out.text({15, 0.5 * (f.top + f.bottom)}, label,
           {.size = kLabel, .anchor = Anchor::middle, .rotate_degrees = -90});
}

void draw_axes(SvgWriter& out, const Frame& f, std::string_view title, std::string_view x_label,
               std::string_view y_label) {
  draw_value_axis(out, f, "", x_label);
  draw_upright_axis(out, f, title, y_label);
  out.line({f.left, f.top}, {f.left, f.bottom}, kAxis);
}

}  // namespace palpate::plot
