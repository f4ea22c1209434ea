// SPDX-License-Identifier: GPL-3.0-or-later
// What `palpate study analyse` is made of.
#pragma once
#include <string>
#include <vector>

#include "study/analysis.hpp"

namespace palpate::app {

/// A figure of the report, also written as figures/NAME.svg.
struct StudyFigure {
  std::string name, svg, caption;
};
/// Every figure that the results allow, in the order of the report. Simulated data say so in each
/// title.
[[nodiscard]] std::vector<StudyFigure> study_figures(const study::StudyData& data,
                                                     const study::Results& results);
/// The report: one page, nothing from outside.
[[nodiscard]] std::string study_report(const study::StudyData& data, const study::Results& results,
                                       const std::vector<StudyFigure>& figures);

}  // namespace palpate::app
