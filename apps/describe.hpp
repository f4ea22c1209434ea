// SPDX-License-Identifier: GPL-3.0-or-later
// Options, reports and heads as JSON, for provenance and for --json.
#pragma once
#include <nlohmann/json.hpp>

#include "apps/pipeline.hpp"

namespace palpate::app {

[[nodiscard]] nlohmann::json describe(const PipelineOptions& options);
[[nodiscard]] nlohmann::json describe(const surface::RepairReport& report);
/// @param unit_mm  [mm] per unit of the positions to be written
[[nodiscard]] nlohmann::json describe(const LandmarkSet& landmarks, double unit_mm);
[[nodiscard]] nlohmann::json describe(const std::vector<DepthRow>& depths);
[[nodiscard]] nlohmann::json describe(const std::vector<stiffness::PublishedSite>& sites);
[[nodiscard]] nlohmann::json describe(const HeadFrame& frame);
/// What `palpate inspect --json` prints.
[[nodiscard]] nlohmann::json describe(const TouchableHead& head);

/// Inverse of describe(landmarks): {"landmarks": {name: {"position": [x, y, z]}}} -> positions.
/// @throws InputError names the file and the landmark
[[nodiscard]] std::map<std::string, Vec3> read_landmark_file(const std::filesystem::path& path);

}  // namespace palpate::app
