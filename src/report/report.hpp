// SPDX-License-Identifier: GPL-3.0-or-later
// One self-contained page that shows what was made and how far it can be trusted.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "core/touchable_head.hpp"

namespace palpate::report {

struct ReportOptions {
  int picture_width = 680;  ///< [px] of each of three side by side; 200 to 4000
};

/// Everything shown comes from the head: repairs, warnings, fit and mesh statistics are read from
/// `head.provenance` (keys repair.lines, warnings, fit, tissue_mesh, sweep, options, input),
/// timings from `head.run` (key seconds: stage -> s). What is absent is left out.
/// @throws FileError  cannot write; nothing is left under the name
void write_report(const std::filesystem::path& path, const TouchableHead& head,
                  const ReportOptions& options = {}, const Progress& progress = {});

}  // namespace palpate::report
