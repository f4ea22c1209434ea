// SPDX-License-Identifier: GPL-3.0-or-later
// Sections of a study's report: what was asked, what came out, how it was tested. Each writes
// nothing where the study has no such data.
#pragma once
#include <string>
#include <vector>

#include "apps/study_analyse.hpp"
#include "report/page.hpp"

namespace palpate::app {

/// The figures of a report by their names.
class Figures {
 public:
  Figures(report::Page& page, const std::vector<StudyFigure>& figures)
      : page_(page), figures_(figures) {}
  /// Nothing where there is none of that name.
  void add(const std::string& name) {
    for (const StudyFigure& f : figures_)
      if (f.name == name) page_.figure(f.svg, f.caption);
  }

 private:
  report::Page& page_;
  const std::vector<StudyFigure>& figures_;
};

void add_ratings(report::Page& page, const study::Results& r, Figures& figures);
void add_groups(report::Page& page, const study::Results& r, Figures& figures);
void add_paired(report::Page& page, const study::Results& r, Figures& figures);
void add_order(report::Page& page, const study::StudyData& data, const study::Results& r,
               Figures& figures);
void add_rationality(report::Page& page, const study::Results& r, Figures& figures);
void add_felt(report::Page& page, const study::Results& r, Figures& figures);
void add_discrimination(report::Page& page, const study::Results& r, Figures& figures);

}  // namespace palpate::app
