// SPDX-License-Identifier: GPL-3.0-or-later
// Error bars: where the map is a guess, the page says so.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/figures.hpp"
#include "report/figures_of_map.hpp"
#include "report/png.hpp"
#include "report/sections.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

/// ± 2 standard deviations of the logarithm, as the factor between the middle and either end.
double factor(double log_sd) {
  return std::exp(2 * log_sd);
}

std::vector<double> factors(const std::vector<double>& log_sd) {
  std::vector<double> out;
  for (const double s : log_sd) out.push_back(factor(s));
  return out;
}

std::vector<double> of_region(const TouchableHead& head, SkinRegion region,
                              const std::vector<double>& values) {
  std::vector<double> some;
  for (std::size_t v = 0; v < values.size(); ++v)
    if (head.map.region[v] == region) some.push_back(values[v]);
  return some;
}

Page::Table region_table(const TouchableHead& head) {
  Page::Table t;
  t.head = {"region", "depth [mm]", "± 1 SD [mm]", "stiffness at 2 N [N/mm]", "low", "high"};
  std::vector<double> k;
  for (std::size_t v = 0; v < head.map.size(); ++v) k.push_back(compared_stiffness(head.map, v));
  for (const SkinRegion r : kPublishedOrder) {
    const double middle = median(of_region(head, r, k));
    const double f = factor(median(of_region(head, r, head.spread.stiffness)));
    t.rows.push_back({std::string(name(r)), fixed(median(of_region(head, r, head.map.depth)), 1),
                      fixed(median(of_region(head, r, head.spread.depth)), 1), fixed(middle, 2),
                      fixed(middle / f, 2), fixed(middle * f, 2)});
  }
  return t;
}

void add_completed(Page& page, const TouchableHead& head, const HeadPictures& pictures) {
  if (head.completed.empty()) return;
  const auto marked = std::count(head.completed.begin(), head.completed.end(), 1);
  page.pictures(
      {{data_url(pictures.marked(View::front, head.completed)), "front"},
       {data_url(pictures.marked(View::three_quarter, head.completed)), "three-quarter"},
       {data_url(pictures.marked(View::left, head.completed)), "from the subject's left"}},
      "",
      fmt::format(
          "The scan is a face alone. Orange: {} of {} vertices where a press moves skin that "
          "was completed from another head; trust the blue ones.",
          grouped(static_cast<std::size_t>(marked)), grouped(head.completed.size())));
}

}  // namespace

void add_spread(Page& page, const TouchableHead& head, const HeadPictures& pictures) {
  if (head.spread.empty()) return;
  page.section("spread", "Error bars");
  add_completed(page, head, pictures);
  page.paragraph(
      "The skull is estimated from the skin, and flesh differs between people. One standard "
      "deviation of the depth and the 95 % range of the stiffness that follow from both are "
      "stored at every vertex.");
  const double high = quantile(head.spread.depth, 0.98);
  const ColorRange range{0, high > 0 ? std::ceil(high) : 1, false};
  page.pictures(
      {{data_url(pictures.values(View::front, head.spread.depth, range)), "front"},
       {data_url(pictures.values(View::three_quarter, head.spread.depth, range)), "three-quarter"},
       {data_url(pictures.values(View::left, head.spread.depth, range)),
        "from the subject's left"}},
      plot::svg(plot::ColorLegend{"depth, one standard deviation [mm]", range.low, range.high,
                                  false, "no bone below", 520}),
      fmt::format("Median {} mm. A skull that was measured counts as exact.",
                  fixed(median(head.spread.depth), 1)));
  const std::vector<double> ratio = factors(head.spread.stiffness);
  if (!std::isfinite(median(ratio))) return;
  const ColorRange times{1, std::max(1.5, std::ceil(2 * quantile(ratio, 0.95)) / 2), false};
  page.pictures(
      {{data_url(pictures.values(View::front, ratio, times)), "front"},
       {data_url(pictures.values(View::three_quarter, ratio, times)), "three-quarter"},
       {data_url(pictures.values(View::left, ratio, times)), "from the subject's left"}},
      plot::svg(plot::ColorLegend{"95 % range of the stiffness at 2 N: times or divided by",
                                  times.low, times.high, false, "no curve", 520}),
      "From the depth's doubt, the spread of flesh between people and the curve's own "
      "error. Where it is large, the map is a guess.");
  page.table(region_table(head));
}

}  // namespace palpate::report
