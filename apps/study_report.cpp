// SPDX-License-Identifier: GPL-3.0-or-later
// The report page of a study. Each section says what was asked, what came out and how it was
// tested.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/study_analyse.hpp"
#include "apps/study_report_sections.hpp"
#include "apps/study_words.hpp"

namespace palpate::app {
namespace {

using namespace study;
namespace st = study::statistics;
using report::Page;

void add_head(Page& page, const StudyData& data, const Results& r) {
  const std::size_t n = r.people.size();
  std::vector<std::string> trust, care;
  if (data.study.simulated)
    care.emplace_back(
        "Some or all participants are programs. This shows that the procedure works; it says "
        "nothing "
        "about people.");
  trust.push_back(fmt::format("{} finished and {} counted", n, n == 1 ? "is" : "are"));
  if (r.unfinished + r.excused + r.withdrawn > 0)
    care.push_back(fmt::format("Not counted: {} unfinished, {} excused, {} withdrawn.",
                               r.unfinished, r.excused, r.withdrawn));
  if (static_cast<int>(n) < data.study.planned_participants)
    care.push_back(fmt::format("{} participants were planned.", data.study.planned_participants));
  const bool ties = std::any_of(r.paired.begin(), r.paired.end(),
                                [](const PairedTest& t) { return t.wilcoxon.ties; });
  if (ties)
    care.emplace_back(
        "Ratings repeat (ties): tests by ranks use the normal approximation with its corrections.");
  trust.emplace_back(
      "Every p of a family of regions is adjusted (Holm); forms of the tests are named.");
  const std::string headline = data.study.simulated
                                   ? fmt::format("SIMULATED DATA: {} participants", n)
                                   : fmt::format("{} participants", n);
  page.verdict(headline, !data.study.simulated && n > 1, trust, care);
}

void add_tiles(Page& page, const Results& r) {
  std::vector<Page::Tile> tiles;
  for (const Ranking& k : r.rankings)
    tiles.push_back({fixed(100 * k.accuracy.moments.mean, 1) + " %",
                     "pairs in the reference order: " + k.title, true});
  for (const Rationality& one : r.rationality)
    tiles.push_back(
        {fixed(one.ratings.moments.mean, 2),
         fmt::format("rationality, mean; against {}: {}", one.reference, p_words(one.t.p)), true});
  for (const FeltAgainstMap& f : r.felt)
    tiles.push_back({fixed(f.spearman.r, 2), "felt with the map, Spearman: " + f.title, true});
  if (!r.discrimination.rows.empty())
    tiles.push_back({fixed(r.discrimination.geometric_mean, 3),
                     "Weber fraction, 95 % " + interval_cell(r.discrimination.interval, 3), true});
  if (!tiles.empty()) page.tiles(tiles);
}

void add_touch(Page& page, const Results& r) {
  if (r.touch.empty()) return;
  page.section("touch", "How it was touched");
  Page::Table table;
  table.head = {
      "part", "place", "trials", "seconds, mean (SD)", "seconds in contact", "largest force [N]"};
  table.text_columns = 2;
  const auto cell = [](const st::Moments& m, int digits) {
    return m.n == 0 ? std::string("–")
                    : fmt::format("{} ({})", fixed(m.mean, digits), fixed(m.sd, digits));
  };
  for (const TouchSummary& t : r.touch)
    table.rows.push_back({t.experiment, t.region, std::to_string(t.duration.n), cell(t.duration, 1),
                          cell(t.contact, 1), cell(t.peak_force, 2)});
  page.begin_details("Times and forces per place");
  page.table(table);
  page.end_details();
}

void add_record(Page& page, const StudyData& data) {
  page.section("record", "Record");
  page.facts({{"protocol", data.study.protocol_name},
              {"published procedure", data.protocol.source.empty() ? "–" : data.protocol.source},
              {"head", data.study.head_name},
              {"fingerprint of the head", data.study.head_fingerprint},
              {"study", data.study.id},
              {"seed of the orders", std::to_string(data.study.seed)},
              {"made with", data.study.program},
              {"participants", data.study.simulated ? "simulated: " + data.study.simulation
                                                    : "people, by pseudonym"}});
  page.begin_details("The protocol as it was");
  for (std::size_t from = 0; from < data.study.protocol_text.size();) {
    const std::size_t end =
        std::min(data.study.protocol_text.find("\n\n", from), data.study.protocol_text.size());
    page.paragraph(std::string_view(data.study.protocol_text).substr(from, end - from));
    from = end + 2;
  }
  page.end_details();
}

}  // namespace

std::string study_report(const StudyData& data, const Results& r,
                         const std::vector<StudyFigure>& all) {
  const std::string mark = data.study.simulated ? " — simulated participants" : "";
  Page page(data.study.title + mark, fmt::format("Study of the head {}; protocol {}",
                                                 data.study.head_name, data.study.protocol_name));
  Figures figures(page, all);
  add_head(page, data, r);
  add_tiles(page, r);
  add_ratings(page, r, figures);
  add_groups(page, r, figures);
  add_paired(page, r, figures);
  add_order(page, data, r, figures);
  add_rationality(page, r, figures);
  add_felt(page, r, figures);
  add_discrimination(page, r, figures);
  add_touch(page, r);
  add_record(page, data);
  return std::move(page).finish();
}

}  // namespace palpate::app
