// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report.hpp"

#include <fmt/format.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "report/sections.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

void check(const TouchableHead& head, const ReportOptions& options) {
  if (options.picture_width < 200 || options.picture_width > 4000)
    throw InputError("report: picture_width must be 200 to 4000 px");
  const std::size_t n = head.skin.points.size();
  const StiffnessMap& m = head.map;
  if (m.status.size() != n || m.error.size() != n || m.depth.size() != n || m.region.size() != n ||
      m.displacement.size() != n * m.forces.size())
    throw InputError(
        fmt::format("report: the map does not have one row for each of {} vertices", n));
}

std::string title_of(const TouchableHead& head) {
  const auto input = head.provenance.find("input");
  if (input != head.provenance.end() && input->is_object() && input->contains("file"))
    return plain_value((*input)["file"]);
  return "Touchable head";
}

}  // namespace

void write_report(const std::filesystem::path& path, const TouchableHead& head,
                  const ReportOptions& options, const Progress& progress) {
  check(head, options);
  progress.step("report", 0);
  const RegionSummary summary = region_summary(head);
  Page page(title_of(head),
            fmt::format("Touchable head: {} vertices, {} triangles, {} mm per unit of the scan.",
                        grouped(head.skin.points.size()), grouped(head.skin.triangles.size()),
                        plain_value(head.unit_mm)));
  add_overview(page, head, summary);
  const HeadPictures pictures(head, options.picture_width);
  progress.step("report", 0.1);
  add_scan_and_landmarks(page, pictures);
  progress.step("report", 0.3);
  add_skull(page, head, pictures);
  progress.step("report", 0.5);
  add_depths(page, head, pictures);
  progress.step("report", 0.6);
  add_stiffness(page, head, summary, pictures);
  progress.step("report", 0.7);
  add_spread(page, head, pictures);
  progress.step("report", 0.8);
  add_coverage(page, head, pictures);
  add_published(page, head);
  add_tissue_mesh(page, head);
  add_record(page, head);
  write_file(path, std::move(page).finish());
  progress.step("report", 1);
}

}  // namespace palpate::report
