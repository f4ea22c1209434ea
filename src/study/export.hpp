// SPDX-License-Identifier: GPL-3.0-or-later
// A study for other programs: tidy tables (one row per observation) and a BIDS data set. Text in
// memory; nothing is written here. UTF-8, '\n', numbers with a point in every locale; simulated
// participants are marked in every table and every description.
#pragma once
#include <string>
#include <vector>

#include "study/analysis.hpp"

namespace palpate::study {

struct ExportFile {
  std::string path;  ///< relative, with '/'
  std::string text;
};

/// tables/*.csv after RFC 4180: trials, selections, comparisons, answers, participants, tests.
/// All participants with data are there (column `state` tells who finished); tests.csv has every
/// test of `results` with its form. Empty cells are missing values.
[[nodiscard]] std::vector<ExportFile> tidy_tables(const StudyData& data, const Results& results);

/// bids/: dataset_description.json, README, participants.tsv and .json, and per participant and
/// experiment sub-*/beh/sub-*_task-*_beh.tsv with one task-*_beh.json for all (inheritance). "n/a"
/// is a missing value. Haptic samples stay in the study file.
/// @cite Gorgolewski et al. 2016, "The brain imaging data structure"; specification 1.8, Behavioral
/// experiments
[[nodiscard]] std::vector<ExportFile> bids_files(const StudyData& data);

}  // namespace palpate::study
