// SPDX-License-Identifier: GPL-3.0-or-later
// W3C, Scalable Vector Graphics 1.1 (Second Edition). Numbers are written by fmt, which ignores the
// locale.
#include "plot/svg_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

namespace palpate::plot {
namespace {

constexpr std::string_view kFont = "system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif";

/// Pixels with at most two decimals and no trailing zeros.
std::string px(double v) {
  std::string text = fmt::format("{:.2f}", v);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string stroke(const StrokeStyle& s) {
  std::string out = fmt::format(" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"",
                                escape_xml(s.color), px(s.width));
  if (s.opacity < 1) out += fmt::format(" stroke-opacity=\"{}\"", px(s.opacity));
  if (!s.dash.empty()) out += fmt::format(" stroke-dasharray=\"{}\"", escape_xml(s.dash));
  return out;
}

std::string fill_text(Paint fill, double opacity) {
  std::string out = fmt::format(" fill=\"{}\"", escape_xml(fill));
  if (opacity < 1) out += fmt::format(" fill-opacity=\"{}\"", px(opacity));
  return out;
}

}  // namespace

std::string escape_xml(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else if (byte < 0x20 && c != '\t' && c != '\n' && c != '\r')
      out += "\xEF\xBF\xBD";
    else
      out += c;
  }
  return out;
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  std::string text = fmt::format("{:.{}g}", value, digits);
  return text == "-0" ? "0" : text;
}

double text_width(std::string_view text, double size) {
  std::size_t letters = 0;
  for (const char c : text) letters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return 0.56 * size * static_cast<double>(letters);
}

SvgWriter::SvgWriter(double width, double height, std::string_view title) {
  body_ = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" font-family=\"{2}\" style=\"color:var(--ink,#1c2126)\">\n"
      "<title>{3}</title>\n",
      px(width), px(height), kFont, escape_xml(title));
}

void SvgWriter::line(PixelPoint from, PixelPoint to, const StrokeStyle& style) {
  body_ += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>\n", px(from.x),
                       px(from.y), px(to.x), px(to.y), stroke(style));
}

void SvgWriter::polyline(const std::vector<PixelPoint>& points, const StrokeStyle& style) {
  if (points.size() < 2) return;
  body_ += "<polyline points=\"";
  for (std::size_t i = 0; i < points.size(); ++i)
    fmt::format_to(std::back_inserter(body_), "{}{},{}", i ? " " : "", px(points[i].x),
                   px(points[i].y));
  body_ += "\" stroke-linejoin=\"round\" stroke-linecap=\"round\"" + stroke(style) + "/>\n";
}

void SvgWriter::rectangle(PixelPoint corner, double width, double height, Paint fill,
                          double opacity) {
  body_ += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>\n", px(corner.x),
                       px(corner.y), px(width), px(height), fill_text(fill, opacity));
}

void SvgWriter::circle(PixelPoint centre, double radius, Paint fill, double opacity) {
  body_ += fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", px(centre.x), px(centre.y),
                       px(radius), fill_text(fill, opacity));
}

void SvgWriter::text(PixelPoint at, std::string_view text, const TextStyle& s) {
  static constexpr std::string_view kAnchors[] = {"start", "middle", "end"};
  body_ += fmt::format("<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\"{}", px(at.x),
                       px(at.y), px(s.size), kAnchors[static_cast<int>(s.anchor)],
                       fill_text(s.fill, s.opacity));
  if (s.bold) body_ += " font-weight=\"600\"";
  if (s.rotate_degrees != 0)
    body_ +=
        fmt::format(" transform=\"rotate({} {} {})\"", px(s.rotate_degrees), px(at.x), px(at.y));
  body_ += fmt::format(">{}</text>\n", escape_xml(text));
}

void SvgWriter::image(PixelPoint corner, double width, double height, std::string_view data_url) {
  body_ += fmt::format("<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"{}\"/>\n",
                       px(corner.x), px(corner.y), px(width), px(height), escape_xml(data_url));
}

std::string SvgWriter::finish() && {
  body_ += "</svg>\n";
  return std::move(body_);
}

}  // namespace palpate::plot
