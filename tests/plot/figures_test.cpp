// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "plot/axis.hpp"
#include "plot/svg_writer.hpp"
#include "xml_check.hpp"

namespace palpate::plot {
namespace {

using test::xml_fault;

const std::string kNasty = "<b> & \"q\" 'a' \x01 Größe";

LinePlot curves() {
  LinePlot p{"Travel against force", "force [N]", "travel [mm]", {}};
  for (int s = 0; s < 7; ++s) {
    Series c{"region " + std::to_string(s), {}, {}, "", ""};
    for (int i = 1; i <= 10; ++i) {
      c.x.push_back(0.5 * i);
      c.y.push_back((1 + s) * (1 - std::exp(-0.4 * i)));
    }
    p.series.push_back(c);
  }
  return p;
}

TEST(Figures, EveryFigureIsWellFormedWithHostileText) {
  EXPECT_EQ(xml_fault("<a><b/></a>"), "");  // the checker itself
  EXPECT_NE(xml_fault("<a><b></a>"), "");
  EXPECT_NE(xml_fault("<a>&</a>"), "");
  LinePlot line = curves();
  line.title = line.x_label = line.y_label = line.series[0].name = line.series[0].color =
      line.series[0].dash = kNasty;
  EXPECT_EQ(xml_fault(svg(line)), "");
  EXPECT_EQ(
      xml_fault(svg(BarChart{kNasty, kNasty, {{kNasty, 2, kNasty, kNasty}, {"", NAN, "", ""}}})),
      "");
  EXPECT_EQ(xml_fault(svg(Histogram{kNasty, kNasty, kNasty, {1, 2, NAN, 3}})), "");
  EXPECT_EQ(xml_fault(svg(RangePlot{kNasty,
                                    kNasty,
                                    kNasty,
                                    kNasty,
                                    {{kNasty, 1, 3, 2, 2.5, true}, {"", 0, 0, 4, NAN, false}}})),
            "");
  EXPECT_EQ(xml_fault(svg(ColorLegend{kNasty, 0.1, 5, true, kNasty})), "");
  EXPECT_EQ(xml_fault(svg(CategoryLegend{{{kNasty, kNasty}, {"b", "#123456"}}})), "");
}

TEST(Figures, EmptyDataStillGivesAFigure) {
  EXPECT_EQ(xml_fault(svg(LinePlot{})), "");
  EXPECT_EQ(xml_fault(svg(BarChart{})), "");
  EXPECT_EQ(xml_fault(svg(Histogram{})), "");
  EXPECT_EQ(xml_fault(svg(RangePlot{})), "");
  EXPECT_EQ(xml_fault(svg(CategoryLegend{})), "");
}

TEST(Figures, SameValueSameBytes) {
  EXPECT_EQ(svg(curves()), svg(curves()));
}

TEST(Figures, NoNumberThatIsNotANumberReachesThePicture) {
  LinePlot p = curves();
  p.series[2].y[4] = NAN;
  p.series[3].y.assign(10, NAN);
  p.series[4].y[9] = INFINITY;
  const std::string text = svg(p);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
  // The broken curve is drawn as two lines; the empty one has no name at its end.
  EXPECT_EQ(text.find(">region 3<"), std::string::npos);
}

TEST(Figures, BarLengthsAreProportional) {
  const std::string text =
      svg(BarChart{"", "N/mm", {{"a", 2, "#000001", ""}, {"b", 1, "#000002", ""}}});
  const auto width = [&](const std::string& color) {
    const auto fill = text.find("fill=\"" + color);
    const auto at = text.rfind("width=\"", fill) + 7;
    return std::stod(text.substr(at));
  };
  EXPECT_NEAR(width("#000001"), 2 * width("#000002"), 0.02);
}

TEST(Figures, RefusesWhatCannotBeDrawn) {
  LinePlot p = curves();
  p.series[1].x.pop_back();
  EXPECT_THROW((void)svg(p), InputError);
  EXPECT_THROW((void)svg(ColorLegend{"a", 1, 1}), InputError);
  EXPECT_THROW((void)svg(ColorLegend{"a", 0, 1, true}), InputError);
  EXPECT_THROW((void)svg(Histogram{.values = {1}, .bins = 0}), InputError);
}

TEST(Axis, TicksAreRoundAndCoverTheRange) {
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{
           {0, 5}, {0, 10.67}, {-3.2, 0.01}, {1e-7, 3e-7}, {99, 101}, {0, 1e6}}) {
    const auto t = linear_ticks(low, high, 6);
    EXPECT_LE(t.front().value, low + 1e-9 * std::abs(low));
    EXPECT_GE(t.back().value, high - 1e-9 * std::abs(high));
    EXPECT_GE(t.size(), 3U);
    EXPECT_LE(t.size(), 12U);
    for (std::size_t i = 0; i < t.size(); ++i)
      EXPECT_NEAR(std::stod(t[i].text), t[i].value, 1e-9 * std::abs(t[i].value)) << t[i].text;
  }
  EXPECT_GE(linear_ticks(3, 3).size(), 2U);
  EXPECT_GE(linear_ticks(NAN, 3).size(), 2U);
}

TEST(Axis, LogTicksStayInside) {
  const auto t = log_ticks(0.15, 7);
  ASSERT_EQ(t.size(), 5U);
  EXPECT_EQ(t.front().text, "0.2");
  EXPECT_EQ(t.back().text, "5");
  EXPECT_EQ(log_ticks(2.1, 2.2).size(), 2U);
}

TEST(NumberText, IsShortAndPlain) {
  EXPECT_EQ(number_text(0.25), "0.25");
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(NAN), "-");
  EXPECT_EQ(number_text(12.3456, 3), "12.3");
}

}  // namespace
}  // namespace palpate::plot
