// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness, coverage, tissue mesh, and the record of how the head was made.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/figures.hpp"
#include "report/figures_of_map.hpp"
#include "report/png.hpp"
#include "report/published.hpp"
#include "report/sections.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

using nlohmann::json;

/// Mean ratings of stiffness, 1 to 10, n = 25, in the published order (the source, its chapter on
/// the user study; docs/method/published.md).
constexpr std::array<double, 7> kPublishedRatings = {8.440, 7.980, 7.380, 5.440,
                                                     5.020, 2.880, 1.780};

const RegionFigures* find(const RegionSummary& summary, SkinRegion region) {
  for (const RegionFigures& f : summary.regions)
    if (f.region == region) return &f;
  return nullptr;
}

std::string region_curves(const TouchableHead& head, const RegionSummary& summary) {
  plot::LinePlot figure;
  figure.x_label = "force [N]";
  figure.y_label = "travel of the tool [mm]";
  for (const SkinRegion r : kPublishedOrder) {
    const RegionFigures* f = find(summary, r);
    if (!f || f->with_curve == 0) continue;
    plot::Series s{std::string(name(r)), {0}, {0}, plot::hex(region_color(r)), ""};
    s.x.insert(s.x.end(), head.map.forces.begin(), head.map.forces.end());
    s.y.insert(s.y.end(), f->median_u.begin(), f->median_u.end());
    figure.series.push_back(std::move(s));
  }
  return plot::svg(figure);
}

std::string region_bars(const RegionSummary& summary) {
  plot::BarChart chart;
  chart.value_label = "median stiffness, 2 N / u(2 N) [N/mm]";
  for (const SkinRegion r : kPublishedOrder)
    if (const RegionFigures* f = find(summary, r))
      chart.bars.push_back({std::string(name(r)), f->stiffness, plot::hex(region_color(r)),
                            fmt::format("{} vertices", grouped(f->with_curve))});
  return plot::svg(chart);
}

Page::Table region_table(const TouchableHead& head, const RegionSummary& summary) {
  Page::Table t;
  t.head = {"region",           "place",
            "published place",  "published rating (1–10)",
            "stiffness [N/mm]", "travel at last force [mm]",
            "depth [mm]",       "vertices",
            "with a curve"};
  for (std::size_t i = 0; i < kPublishedOrder.size(); ++i) {
    const RegionFigures* f = find(summary, kPublishedOrder[i]);
    const auto at = std::find(summary.order.begin(), summary.order.end(), kPublishedOrder[i]);
    const std::string place =
        at == summary.order.end() ? "–" : fmt::format("{}", at - summary.order.begin() + 1);
    std::vector<std::string> row = {std::string(name(kPublishedOrder[i])), place,
                                    fmt::format("{}", i + 1), fixed(kPublishedRatings[i], 2)};
    if (f)
      row.insert(row.end(), {fixed(f->stiffness, 2),
                             head.map.forces.empty() ? "–" : fixed(f->median_u.back(), 2),
                             fixed(f->depth, 1), grouped(f->vertices), grouped(f->with_curve)});
    else
      row.insert(row.end(), {"–", "–", "–", "0", "0"});
    t.rows.push_back(std::move(row));
  }
  return t;
}

std::string order_sentence(const RegionSummary& summary) {
  std::string text = "From stiff to soft: ";
  for (std::size_t i = 0; i < summary.order.size(); ++i)
    text += (i ? ", " : "") + std::string(name(summary.order[i]));
  text += ". Published: ";
  for (std::size_t i = 0; i < kPublishedOrder.size(); ++i)
    text += (i ? ", " : "") + std::string(name(kPublishedOrder[i]));
  text += ".";
  if (summary.kendall_tau) text += fmt::format(" Kendall tau {:.2f}.", *summary.kendall_tau);
  return text;
}

/// Rows of an object of numbers and texts; members that are objects themselves are left out.
std::vector<std::pair<std::string, std::string>> flat(const json& object) {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& [key, value] : object.items())
    if (!value.is_object()) rows.emplace_back(with_unit(key), plain_value(value));
  return rows;
}

void add_object(Page& page, const json& holder, const char* key, std::string_view title) {
  const auto found = holder.find(key);
  if (found == holder.end() || !found->is_object() || found->empty()) return;
  page.begin_details(title);
  page.facts(flat(*found));
  page.end_details();
}

/// What the travel is measured of; the published recipe has no tool.
std::string what_presses(const TouchableHead& head) {
  if (!published_loads(head).empty())
    return "u is the travel of the pressed vertex along the inward normal; the force acts on that "
           "one node.";
  return fmt::format(
      "u is the travel of a sphere of radius {} mm along the inward normal, from "
      "first contact.",
      fixed(head.map.tool_radius, 1));
}

}  // namespace

void add_stiffness(Page& page, const TouchableHead& head, const RegionSummary& summary,
                   const HeadPictures& pictures) {
  page.section("stiffness", "Stiffness");
  const ColorRange range = stiffness_range(head.map);
  page.pictures({{data_url(pictures.stiffness(View::front, range)), "front"},
                 {data_url(pictures.stiffness(View::three_quarter, range)), "three-quarter"},
                 {data_url(pictures.stiffness(View::left, range)), "from the subject's left"}},
                plot::svg(plot::ColorLegend{"stiffness 2 N / u(2 N) [N/mm], logarithmic", range.low,
                                            range.high, true, "no curve", 520}),
                what_presses(head));
  if (summary.order.empty()) return;
  page.subsection("The seven regions");
  page.figure(region_curves(head, summary), "Median travel of each region against force.");
  page.figure(region_bars(summary), "In the published order: bars should shorten downwards.");
  page.paragraph(order_sentence(summary));
  page.table(region_table(head, summary));
}

void add_coverage(Page& page, const TouchableHead& head, const HeadPictures& pictures) {
  page.section("coverage", "Regions and coverage");
  plot::CategoryLegend regions;
  for (const SkinRegion r : kPublishedOrder)
    regions.entries.push_back({std::string(name(r)), plot::hex(region_color(r))});
  for (const SkinRegion r : {SkinRegion::eye, SkinRegion::nose, SkinRegion::lips, SkinRegion::ear,
                             SkinRegion::neck, SkinRegion::other})
    regions.entries.push_back({std::string(name(r)), plot::hex(region_color(r))});
  page.pictures({{data_url(pictures.regions(View::front)), "front"},
                 {data_url(pictures.regions(View::three_quarter)), "three-quarter"},
                 {data_url(pictures.regions(View::left)), "from the subject's left"}},
                plot::svg(regions), "Regions of the skin; the seven in colour are compared.");

  std::array<std::size_t, kVertexStatusNames.size()> count{};
  for (const VertexStatus s : head.map.status) ++count[static_cast<std::size_t>(s)];
  plot::CategoryLegend statuses;
  Page::Table t{{"status", "meaning", "vertices", "share"}, {}, {}, 2};
  static constexpr std::array<std::string_view, kVertexStatusNames.size()> kMeaning = {
      "pressed in full, the curve is the solver's own",
      "blended from solved neighbours",
      "no bone under the skin within reach: no curve",
      "carried by another organ: no curve",
      "the solver did not converge: no curve",
      "the published recipe turns tissue inside out, here or at the nearest pressed vertex: no "
      "curve",
      "the published recipe does not come to rest, here or at the nearest pressed vertex: no "
      "curve"};
  const double all = std::max<double>(1, static_cast<double>(head.map.size()));
  for (std::size_t s = 0; s < count.size(); ++s) {
    const auto status = static_cast<VertexStatus>(s);
    if (status > VertexStatus::failed && count[s] == 0) continue;  // another recipe's
    statuses.entries.push_back({plain_words(name(status)), plot::hex(status_color(status))});
    t.rows.push_back({plain_words(name(status)), std::string(kMeaning[s]), grouped(count[s]),
                      fixed(100 * static_cast<double>(count[s]) / all, 1) + " %"});
    if (status >= VertexStatus::failed && count[s]) t.marked.push_back(t.rows.size() - 1);
  }
  page.pictures({{data_url(pictures.status(View::front)), "front"},
                 {data_url(pictures.status(View::three_quarter)), "three-quarter"},
                 {data_url(pictures.status(View::left)), "from the subject's left"}},
                plot::svg(statuses), "Where curves come from; every dark bead is a solved point.");
  page.table(t);

  std::vector<double> percent;
  const std::vector<double> error = errors_on_bone(head.map);
  for (std::size_t v = 0; v < error.size(); ++v)
    if (head.map.status[v] == VertexStatus::blended && std::isfinite(error[v]))
      percent.push_back(100 * error[v]);
  if (percent.empty()) return;
  page.subsection("Estimated error of blending");
  const double p95 = quantile(percent, 0.95), p99 = quantile(percent, 0.99);
  page.figure(
      plot::svg(plot::Histogram{.x_label = "estimated relative error of the travel [%]",
                                .y_label = "vertices",
                                .values = percent,
                                .low = 0,
                                .high = std::max(1.0, std::ceil(p99))}),
      fmt::format("Median {} %, 95th percentile {} %, largest {} %; the last bar holds all "
                  "beyond the scale.",
                  fixed(median(percent), 1), fixed(p95, 1), fixed(quantile(percent, 1), 1)));
}

void add_tissue_mesh(Page& page, const TouchableHead& head) {
  const auto mesh = head.provenance.find("tissue_mesh");
  if (mesh == head.provenance.end() || !mesh->is_object() || mesh->empty()) return;
  page.section("mesh", "Tissue mesh");
  std::vector<std::pair<std::string, std::string>> rows;
  plot::LinePlot angles;
  angles.x_label = "dihedral angle [°]";
  angles.y_label = "share of all angles [%]";
  angles.height = 260;
  plot::Series share;
  for (const auto& [key, value] : mesh->items()) {
    constexpr std::string_view kShare = "dihedral_share_";
    if (!key.starts_with(kShare))
      rows.emplace_back(with_unit(key), plain_value(value));
    else if (value.is_number() && key.size() >= kShare.size() + 3) {
      share.x.push_back(std::atof(key.c_str() + kShare.size()) + 5);
      share.y.push_back(100 * value.get<double>());
    }
  }
  page.facts(rows);
  if (share.x.empty()) return;
  angles.series.push_back(std::move(share));
  page.figure(plot::svg(angles), "Dihedral angles of the tetrahedra; good ones lie near 70°.");
}

void add_record(Page& page, const TouchableHead& head) {
  page.section("record", "How this head was made");
  const json& p = head.provenance;
  if (const auto repair = p.find("repair"); repair != p.end() && repair->is_object()) {
    page.subsection("Repairs of the scan");
    std::vector<std::string> lines;
    if (const auto found = repair->find("lines"); found != repair->end() && found->is_array())
      for (const auto& line : *found) lines.push_back(plain_value(line));
    if (lines.empty()) lines.emplace_back("nothing had to be repaired");
    page.list(lines);
  }
  if (const auto seconds = head.run.find("seconds");
      seconds != head.run.end() && seconds->is_object() && !seconds->empty()) {
    page.subsection("Time");
    plot::BarChart chart;
    chart.value_label = "wall time [s]";
    for (const auto& [stage, s] : seconds->items())
      if (s.is_number()) chart.bars.push_back({plain_words(stage), s.get<double>(), "", ""});
    page.figure(plot::svg(chart),
                head.run.contains("threads")
                    ? "Threads asked for (0: all cores): " + plain_value(head.run["threads"]) + "."
                    : "");
  }
  page.subsection("Provenance");
  std::vector<std::pair<std::string, std::string>> rows;
  if (p.contains("palpate")) rows.emplace_back("Palpate", plain_value(p["palpate"]));
  if (const auto input = p.find("input"); input != p.end() && input->is_object())
    for (const auto& row : flat(*input)) rows.push_back(row);
  page.facts(rows);
  add_object(page, p, "options", "Options");
  add_object(page, p, "sweep", "Statistics of the sweep");
  add_object(page, p, "repair", "Statistics of the repair");
}

}  // namespace palpate::report
