// SPDX-License-Identifier: Apache-2.0
// The project's own data: the skull template, the depth table, the bundled head.
#pragma once
#include <filesystem>
#include <vector>

#include "core/skull.hpp"

namespace palpate::io {

/// Folder of the bundled data: $PALPATE_DATA, else ../share/palpate beside the program, else data/
/// of the source tree it was built from. @throws InputError naming what was tried
[[nodiscard]] std::filesystem::path data_folder();
/// `<stem>.ply` with a `region` byte per vertex and `<stem>.json` beside it.
[[nodiscard]] SkullTemplate read_skull_template(const std::filesystem::path& ply);
/// CSV: code,landmark,mean_mm,sd_mm,population,source.
[[nodiscard]] std::vector<TissueDepth> read_tissue_depths(const std::filesystem::path& csv);

}  // namespace palpate::io
