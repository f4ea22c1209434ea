// SPDX-License-Identifier: GPL-3.0-or-later
// Overview, scan, landmarks, skull, depths.
#include <fmt/format.h>

#include <cmath>

#include "plot/figures.hpp"
#include "report/figures_of_map.hpp"
#include "report/png.hpp"
#include "report/sections.hpp"
#include "report/verdict.hpp"
#include "report/words.hpp"

namespace palpate::report {

/// Warnings recorded with the head; none where there are none.
static std::vector<std::string> warnings_of(const TouchableHead& head) {
  std::vector<std::string> out;
  const auto list = head.provenance.find("warnings");
  if (list != head.provenance.end() && list->is_array())
    for (const auto& w : *list) out.push_back(plain_value(w));
  return out;
}

static std::vector<Page::Tile> key_figures(const TouchableHead& head,
                                           const RegionSummary& summary) {
  std::vector<Page::Tile> tiles;
  std::size_t with_curve = 0;
  for (std::size_t v = 0; v < head.map.size(); ++v) with_curve += head.map.has_curve(v);
  const double share = head.map.size() ? 100.0 * static_cast<double>(with_curve) /
                                             static_cast<double>(head.map.size())
                                       : 0;
  tiles.push_back({fixed(share, 0) + " %", "of " + grouped(head.map.size()) + " vertices felt",
                   with_curve > 0});
  const double error = median(errors_on_bone(head.map));
  if (std::isfinite(error))
    tiles.push_back({fixed(100 * error, 1) + " %", "blending error, median", true});
  const DepthAgreement a = depth_agreement(head.depths);
  if (a.compared)
    tiles.push_back({fmt::format("{} / {}", a.within, a.compared),
                     fmt::format("depths within {} SD", kDepthSd),
                     10 * a.within >= 7 * a.compared});
  if (summary.kendall_tau)
    tiles.push_back({fixed(*summary.kendall_tau, 2), "order of regions, Kendall tau",
                     *summary.kendall_tau >= 0.7});
  double seconds = 0;
  if (const auto run = head.run.find("seconds"); run != head.run.end() && run->is_object())
    for (const auto& [stage, s] : run->items())
      if (s.is_number()) seconds += s.get<double>();
  if (seconds > 0) tiles.push_back({fixed(seconds, 0) + " s", "to make", true});
  return tiles;
}

void add_overview(Page& page, const TouchableHead& head, const RegionSummary& summary) {
  const Verdict v = judge(head, summary);
  page.verdict(v.sound ? "This head can be used: every check that it was put to holds."
                       : "Use this head with care: a check did not hold (right column, first).",
               v.sound, v.trust, v.care);
  page.tiles(key_figures(head, summary));
  if (const auto warnings = warnings_of(head); !warnings.empty()) {
    page.subsection("Warnings");
    page.list(warnings, "care");
  }
}

void add_scan_and_landmarks(Page& page, const HeadPictures& pictures) {
  page.section("scan", "Scan and landmarks");
  page.pictures({{data_url(pictures.scan(View::front)), "front"},
                 {data_url(pictures.scan(View::three_quarter)), "three-quarter"},
                 {data_url(pictures.scan(View::left)), "from the subject's left"}},
                "", "The scan as given, turned into the head frame.");
  page.figure(pictures.landmarks_svg(),
              "Landmarks with their confidence from 0 to 1; orange below 0.5. Left and right are "
              "the subject's.");
}

void add_skull(Page& page, const TouchableHead& head, const HeadPictures& pictures) {
  if (head.skull.empty()) return;
  page.section("skull", "Skull");
  page.pictures({{data_url(pictures.skull(View::front)), "front"},
                 {data_url(pictures.skull(View::three_quarter)), "three-quarter"},
                 {data_url(pictures.skull(View::left)), "from the subject's left"}},
                "", "The fitted skull in the skin, which is drawn translucent.");
  const auto fit = head.provenance.find("fit");
  if (fit == head.provenance.end() || !fit->is_object() || fit->empty()) return;
  page.begin_details("Statistics of the fit");
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& [key, value] : fit->items())
    rows.emplace_back(with_unit(key), plain_value(value));
  page.facts(rows);
  page.end_details();
}

static std::string depth_figure(const std::vector<DepthRow>& depths) {
  plot::RangePlot figure;
  figure.value_label = "depth of the soft tissue [mm]";
  figure.band_name = fmt::format("published mean ± {} SD", kDepthSd);
  figure.value_name = "this head: inside, outside";
  for (const DepthRow& row : depths) {
    const double z = z_score(row);
    figure.rows.push_back({landmark_name(row.code), row.published_mm - kDepthSd * row.sd_mm,
                           row.published_mm + kDepthSd * row.sd_mm, row.published_mm,
                           row.reached ? row.depth_mm : NAN, !(std::abs(z) > kDepthSd)});
  }
  return plot::svg(figure);
}

static Page::Table depth_table(const std::vector<DepthRow>& depths) {
  Page::Table t;
  t.head = {"landmark", "depth [mm]", "published [mm]", "SD [mm]", "difference [mm]", "z [SD]"};
  for (const DepthRow& row : depths) {
    const double z = z_score(row);
    if (std::abs(z) > kDepthSd) t.marked.push_back(t.rows.size());
    const double depth = row.reached ? row.depth_mm : NAN;
    t.rows.push_back({landmark_name(row.code), row.reached ? fixed(depth, 1) : "not in the scan",
                      fixed(row.published_mm, 1), row.sd_mm > 0 ? fixed(row.sd_mm, 1) : "–",
                      fixed(depth - row.published_mm, 1), fixed(z, 1)});
  }
  return t;
}

void add_depths(Page& page, const TouchableHead& head, const HeadPictures& pictures) {
  page.section("depth", "Tissue depth");
  const ColorRange range = depth_range(head.map);
  page.pictures({{data_url(pictures.depth(View::front, range)), "front"},
                 {data_url(pictures.depth(View::three_quarter, range)), "three-quarter"},
                 {data_url(pictures.depth(View::left, range)), "from the subject's left"}},
                plot::svg(plot::ColorLegend{"tissue depth [mm]", range.low, range.high, false,
                                            "no bone below", 520}),
                "Skin to bone along the inward normal; values above the scale take its last "
                "colour.");
  if (head.depths.empty()) return;
  page.subsection("Against the published depths");
  page.figure(depth_figure(head.depths),
              "From the bone's landmark to the skin. Rows without a band have no published SD. A "
              "true skull has about 87 % of its depths within the bands.");
  page.begin_details("The same as a table");
  page.table(depth_table(head.depths));
  page.end_details();
}

}  // namespace palpate::report
