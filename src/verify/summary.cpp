// SPDX-License-Identifier: GPL-3.0-or-later
// The sections as text and as a page.
#include <fmt/format.h>

#include <cmath>

#include "core/version.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

std::string number(double v) {
  if (v == 0 || (std::abs(v) >= 0.001 && std::abs(v) < 1000)) return fmt::format("{:.4g}", v);
  return fmt::format("{:.2e}", v);
}

std::string limit(const Figure& f) {
  return (f.at_least ? "≥ " : "≤ ") + number(f.limit);
}

}  // namespace

std::string text_table(const std::vector<Section>& sections) {
  std::string out;
  for (const Section& s : sections) {
    out += fmt::format("{} ({:.0f} s)\n", s.title, s.seconds);
    for (const Figure& f : s.figures)
      out += fmt::format("  {:<66} {:>10} {:>10}  {}{}\n", f.what,
                         f.verdict == Verdict::not_run ? "" : number(f.value), limit(f),
                         name(f.verdict), f.note.empty() ? "" : " (" + f.note + ")");
  }
  return out;
}

std::string html_page(const std::vector<Section>& sections) {
  report::Page page("Verification of Palpate's mechanics", std::string("version ") + kVersion);
  std::size_t met = 0, missed = 0, skipped = 0;
  report::Page::Table all{{"figure", "section", "verdict", "measured", "limit"}, {}};
  all.text_columns = 3;
  for (const Section& s : sections)
    for (const Figure& f : s.figures) {
      ++(f.verdict == Verdict::met ? met : f.verdict == Verdict::missed ? missed : skipped);
      if (f.verdict == Verdict::missed) all.marked.push_back(all.rows.size());
      all.rows.push_back({f.what, s.title, name(f.verdict),
                          f.verdict == Verdict::not_run ? "" : number(f.value), limit(f)});
    }
  page.tiles({{fmt::format("{}", met), "figures met"},
              {fmt::format("{}", missed), "missed", missed == 0},
              {fmt::format("{}", skipped), "not run", skipped == 0}});
  page.section("figures", "Figures");
  page.table(all);
  for (const Section& s : sections) {
    page.section(s.id, s.title);
    page.paragraph(s.text);
    for (const Figure& f : s.figures)
      if (!f.note.empty()) page.paragraph(f.what + ": " + f.note + ".");
    for (const plot::LinePlot& p : s.plots) page.figure(plot::svg(p), p.title);
    for (const report::Page::Table& t : s.tables) page.table(t);
  }
  return std::move(page).finish();
}

}  // namespace palpate::verify
