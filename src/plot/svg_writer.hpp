// SPDX-License-Identifier: GPL-3.0-or-later
// A small SVG 1.1 writer: what the figures need and no more.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::plot {

/// & < > " ' as entities; control characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escape_xml(std::string_view text);

/// Shortest text of a number in at most `digits` significant digits; "-" for NaN and infinities.
/// Independent of the locale: the same value gives the same text everywhere.
[[nodiscard]] std::string number_text(double value, int digits = 4);

/// "#rrggbb" or a CSS colour; "currentColor" takes the page's ink, so that a figure inlined into a
/// page follows its light or dark scheme.
using Paint = std::string_view;

enum class Anchor { start, middle, end };

struct TextStyle {
  double size = 12;  ///< [px]
  Anchor anchor = Anchor::start;
  Paint fill = "currentColor";
  double opacity = 1;
  double rotate_degrees = 0;
  bool bold = false;
};
struct StrokeStyle {
  Paint color = "currentColor";
  double width = 1;  ///< [px]
  double opacity = 1;
  std::string_view dash = "";  ///< as SVG's stroke-dasharray; "" is solid
};
struct PixelPoint {
  double x = 0, y = 0;  ///< [px] x to the right, y down
};

/// Collects elements; finish() returns the whole document. Coordinates are rounded to 1/100 px.
class SvgWriter {
 public:
  SvgWriter(double width, double height, std::string_view title);
  void line(PixelPoint from, PixelPoint to, const StrokeStyle& style = {});
  void polyline(const std::vector<PixelPoint>& points, const StrokeStyle& style = {});
  void rectangle(PixelPoint corner, double width, double height, Paint fill, double opacity = 1);
  void circle(PixelPoint centre, double radius, Paint fill, double opacity = 1);
  void text(PixelPoint at, std::string_view text, const TextStyle& style = {});
  /// A picture as data: URL, stretched over the rectangle.
  void image(PixelPoint corner, double width, double height, std::string_view data_url);
  [[nodiscard]] std::string finish() &&;

 private:
  std::string body_;
};

/// Width [px] that a text takes in a common sans-serif face, for the layout only.
[[nodiscard]] double text_width(std::string_view text, double size);

}  // namespace palpate::plot
