// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/figures.hpp"
#include "report/figures_of_map.hpp"
#include "report/sections.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

using nlohmann::json;

/// One site of the record, a number per force.
struct Site {
  std::vector<double> u;
  std::vector<int> inverted;
  std::vector<bool> at_rest;
  [[nodiscard]] bool good(std::size_t i) const {
    return i < u.size() && at_rest[i] && inverted[i] == 0;
  }
};

std::vector<Site> sites_of(const TouchableHead& head) {
  std::vector<Site> sites;
  const auto list = head.provenance.find("published_sites");
  if (list == head.provenance.end()) return sites;
  const std::size_t n = head.map.forces.size();
  try {
    for (const json& entry : *list) {
      Site s;
      for (const json& u : entry.at("u_mm")) s.u.push_back(u.is_null() ? NAN : u.get<double>());
      s.inverted = entry.at("inverted_tets").get<std::vector<int>>();
      s.at_rest = entry.at("at_rest").get<std::vector<bool>>();
      const std::size_t m = s.u.size();
      if (m > 0 && m <= n && s.inverted.size() == m && s.at_rest.size() == m) sites.push_back(s);
    }
  } catch (const json::exception&) {
    sites.clear();  // written by hand or damaged: the map's own status still tells the outcome
  }
  return sites;
}

/// Every site's travel; the part that means nothing is drawn thin and red.
std::string site_curves(const TouchableHead& head, const std::vector<Site>& sites) {
  plot::LinePlot figure;
  figure.x_label = "force [N]";
  figure.y_label = "displacement of the pushed node [mm]";
  for (const Site& s : sites) {
    plot::Series good{"", {0}, {0}, "#14457f", ""}, bad{"", {}, {}, "#d6332e", "3 3"};
    for (std::size_t i = 0; i < s.u.size(); ++i) {
      if (!s.good(i) && bad.x.empty()) {  // from the last point that means something
        bad.x = {good.x.back()};
        bad.y = {good.y.back()};
      }
      (s.good(i) ? good : bad).x.push_back(head.map.forces[i]);
      (s.good(i) ? good : bad).y.push_back(s.u[i]);
    }
    bad.markers = false;
    if (!bad.x.empty()) figure.series.push_back(std::move(bad));
    if (good.x.size() > 1) figure.series.push_back(std::move(good));
  }
  return plot::svg(figure);
}

}  // namespace

std::vector<PublishedLoad> published_loads(const TouchableHead& head) {
  const std::vector<Site> sites = sites_of(head);
  std::vector<PublishedLoad> out;
  if (sites.empty()) return out;
  for (std::size_t i = 0; i < head.map.forces.size(); ++i) {
    PublishedLoad load;
    load.force = head.map.forces[i];
    std::vector<double> all, good;
    for (const Site& s : sites) {
      ++load.sites;
      const std::size_t last = std::min(i, s.u.size() - 1);
      load.inverted += s.inverted[last] > 0;
      load.restless += !s.at_rest[last];
      load.good += s.good(i);
      if (i < s.u.size() && std::isfinite(s.u[i])) all.push_back(s.u[i]);
      if (s.good(i)) good.push_back(s.u[i]);
    }
    load.median_u = median(all);
    load.median_good_u = median(good);
    out.push_back(load);
  }
  return out;
}

void add_published(Page& page, const TouchableHead& head) {
  const std::vector<PublishedLoad> loads = published_loads(head);
  if (loads.empty()) return;
  page.section("published", "The published recipe");
  page.paragraph(
      "This head was pressed as the source describes it: a force on one node of the skin, linear "
      "tetrahedra of Saint-Venant-Kirchhoff tissue, dynamics stepped until nothing moves. Where "
      "that turns tissue inside out or does not come to rest, the displacement means nothing; it "
      "is listed here as the recipe reports it, larger forces were not tried, and the map has no "
      "curve there.");
  Page::Table t{{"force [N]", "sites", "inside out", "not at rest", "good",
                 "median displacement, good sites [mm]", "median as reported, all tried [mm]"},
                {},
                {},
                0};
  for (const PublishedLoad& l : loads) {
    if (l.good < l.sites) t.marked.push_back(t.rows.size());
    t.rows.push_back({fixed(l.force, 3), grouped(l.sites), grouped(l.inverted), grouped(l.restless),
                      grouped(l.good), l.good > 0 ? fixed(l.median_good_u, 2) : "–",
                      std::isfinite(l.median_u) ? fixed(l.median_u, 2) : "–"});
  }
  page.table(t);
  page.figure(site_curves(head, sites_of(head)),
              "Every pressed site. Blue: at rest and no tissue inside out. Red, dashed: what the "
              "recipe reports beyond that.");
}

}  // namespace palpate::report
