// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot/comparisons.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.hpp"
#include "xml_check.hpp"

namespace palpate::plot {
namespace {

using test::xml_fault;
const std::string kNasty = "<b> & \"q\" 'a' \x01 Größe";

/// Values of an attribute of all elements that hold `with`.
std::vector<double> attribute(const std::string& svg, const std::string& with,
                              const std::string& name) {
  std::vector<double> out;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::string element = svg.substr(at, svg.find('>', at) - at);
    const auto value = element.find(" " + name + "=\"");
    if (element.find(with) != std::string::npos && value != std::string::npos)
      out.push_back(std::stod(element.substr(value + name.size() + 3)));
  }
  return out;
}

TEST(Comparisons, AreWellFormedWithHostileText) {
  EXPECT_EQ(xml_fault(svg(ColumnChart{kNasty,
                                      kNasty,
                                      {{kNasty, kNasty}, {"b", ""}},
                                      {{kNasty, {{1, 0.5, 1.5}, {2, NAN, NAN}}, kNasty}}})),
            "");
  EXPECT_EQ(
      xml_fault(svg(StripPlot{kNasty, kNasty, {{kNasty, {1, 2, NAN, 2}, kNasty}}, 1.5, kNasty})),
      "");
  EXPECT_EQ(xml_fault(svg(
                SlopePlot{kNasty, kNasty, kNasty, kNasty, {{kNasty, {{1, 2}, {NAN, 3}}, kNasty}}})),
            "");
  EXPECT_EQ(xml_fault(svg(DotPlot{kNasty,
                                  kNasty,
                                  kNasty,
                                  {{1, 2, 1, 3, 1, kNasty}},
                                  kNasty,
                                  {{kNasty, {1, 2}, {3, NAN}, kNasty, kNasty}},
                                  true,
                                  true,
                                  0,
                                  1,
                                  kNasty})),
            "");
}

TEST(Comparisons, EmptyOrMissingDataStillGiveAFigure) {
  EXPECT_EQ(xml_fault(svg(ColumnChart{})), "");
  EXPECT_EQ(xml_fault(svg(StripPlot{})), "");
  EXPECT_EQ(xml_fault(svg(SlopePlot{})), "");
  EXPECT_EQ(xml_fault(svg(DotPlot{})), "");
  for (const std::string& text :
       {svg(ColumnChart{"", "", {{"a", ""}}, {{"g", {{NAN, NAN, NAN}}, ""}}}),
        svg(StripPlot{"", "", {{"a", {NAN}, ""}, {"b", {INFINITY}, ""}}}),
        svg(SlopePlot{"", "", "l", "r", {{"a", {{NAN, 1}}, ""}}}),
        svg(DotPlot{"", "", "", {{NAN, 1, NAN, NAN, 1, "x"}, {1, INFINITY, 0, 0, 1, ""}}})}) {
    EXPECT_EQ(xml_fault(text), "");
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf"), std::string::npos);
  }
}

TEST(Columns, HeightsAreProportionalFromTheBase) {
  const std::string text = svg(ColumnChart{
      "", "", {{"a", "#000001"}, {"b", "#000002"}}, {{"g", {{4, NAN, NAN}, {2, NAN, NAN}}, ""}}});
  // The legend's swatches come first.
  const auto a = attribute(text, "#000001", "height"), b = attribute(text, "#000002", "height");
  ASSERT_EQ(a.size(), 2U);
  EXPECT_NEAR(a[1], 2 * b[1], 0.03);
  EXPECT_THROW((void)svg(ColumnChart{"", "", {}, {{"g", {{1, 0, 2}}, ""}}}), InputError);
}

TEST(Strips, EqualValuesDoNotHideEachOther) {
  const std::string text = svg(StripPlot{"", "", {{"a", {5, 5, 5, 5, 6}, "#000001"}}});
  const auto x = attribute(text, "<circle", "cx"), y = attribute(text, "<circle", "cy");
  ASSERT_EQ(x.size(), 5U);
  std::set<std::pair<double, double>> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.insert({x[i], y[i]});
  EXPECT_EQ(places.size(), 5U);
  EXPECT_EQ(std::set<double>(y.begin(), y.end()).size(), 2U);
}

TEST(Slopes, OneLinePerCompletePairAndTheMean) {
  const std::string text =
      svg(SlopePlot{"", "", "l", "r", {{"a", {{1, 2}, {3, 4}, {NAN, 4}, {2, 1}}, ""}}});
  EXPECT_EQ(attribute(text, "stroke-opacity=\"0.5\"", "x1").size(), 3U);
  EXPECT_EQ(attribute(text, "stroke-width=\"3\"", "x1").size(), 1U);
}

TEST(Dots, CurveOfUnequalLengthsIsRefused) {
  EXPECT_THROW((void)svg(DotPlot{"", "", "", {}, "", {{"c", {1, 2}, {1}, "", ""}}}), InputError);
}

}  // namespace
}  // namespace palpate::plot
