// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue models from TOML files (docs/formats.md).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "stiffness/tissue_model.hpp"

namespace palpate::app {

/// @param word  published, regional, layered (bundled files), or the path of a .toml
/// @throws InputError  file:line and the key, for a syntax error, an unknown key or a wrong value
[[nodiscard]] stiffness::TissueModel read_tissue_model(const std::string& word);
/// For the provenance: the name, where its figures come from, and all of them.
[[nodiscard]] nlohmann::json describe(const stiffness::TissueModel& model);

}  // namespace palpate::app
