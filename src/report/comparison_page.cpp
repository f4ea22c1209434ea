// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>

#include "core/atomic_file.hpp"
#include "plot/figures.hpp"
#include "report/comparison.hpp"
#include "report/figures_of_map.hpp"
#include "report/page.hpp"
#include "report/pictures.hpp"
#include "report/png.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

constexpr int kPictureWidth = 680;  // [px]

std::vector<double> sizes(std::vector<double> x, double scale) {
  for (double& v : x) v = scale * std::abs(v);
  return x;
}

void add_map(Page& page, const HeadPictures& pictures, const std::vector<double>& values,
             double step, const std::string& label) {
  const double high = quantile(values, 0.98);
  const ColorRange range{0, high > 0 ? step * std::ceil(high / step) : step, false};
  page.pictures(
      {{data_url(pictures.values(View::front, values, range)), "front"},
       {data_url(pictures.values(View::three_quarter, values, range)), "three-quarter"},
       {data_url(pictures.values(View::left, values, range)), "from the subject's left"}},
      plot::svg(plot::ColorLegend{label, range.low, range.high, false, "not compared", 520}),
      "Values above the scale take its last colour.");
}

std::vector<std::string> row(const std::string& name, const RegionComparison& r) {
  return {name,
          grouped(r.vertices),
          fixed(r.depth_error, 2),
          fixed(r.depth_bias, 2),
          fixed(100 * r.stiffness_error, 1),
          fixed(100 * r.within_two_sd, 1),
          fixed(r.stated_sd, 2)};
}

}  // namespace

void write_comparison(const std::filesystem::path& path, const TouchableHead& estimated,
                      const Comparison& c, const Progress& progress) {
  Page page("Estimated against known skull",
            fmt::format("{} vertices compared: {} mm mean difference of depth, {} % median "
                        "difference of the stiffness at 2 N.",
                        grouped(c.all.vertices), fixed(c.all.depth_error, 2),
                        fixed(100 * c.all.stiffness_error, 1)));
  page.section("regions", "By region");
  Page::Table table;
  table.head = {"region",
                "vertices",
                "depth error, mean [mm]",
                "depth bias, median [mm]",
                "stiffness error, median [%]",
                "within 2 SD [%]",
                "stated SD, mean [mm]"};
  table.rows.push_back(row("all", c.all));
  for (const RegionComparison& r : c.regions)
    table.rows.push_back(row(std::string(name(r.region)), r));
  page.table(table);
  page.paragraph(fmt::format(
      "Over the face the depth is {} mm off in the mean; the one constant depth that suits this "
      "head best would be {} mm off.",
      fixed(c.face_error, 2), fixed(c.face_constant_error, 2)));
  progress.step("compare", 0.3);
  const HeadPictures pictures(estimated, kPictureWidth);
  page.section("depth", "Difference of depth");
  add_map(page, pictures, sizes(c.depth, 1), 1, "depth, estimated against known [mm]");
  progress.step("compare", 0.7);
  page.section("stiffness", "Difference of stiffness at 2 N");
  add_map(page, pictures, sizes(c.stiffness, 100), 10, "stiffness, estimated against known [%]");
  write_file(path, std::move(page).finish());
  progress.step("compare", 1);
}

}  // namespace palpate::report
