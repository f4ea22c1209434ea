// SPDX-License-Identifier: Apache-2.0
// A fitted skull with the depth of the tissue above it, vertex by vertex of the scan: what a fit
// tells before anything is pressed (docs/formats.md).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/landmarks.hpp"
#include "core/regions.hpp"
#include "core/surface_mesh.hpp"

namespace palpate::io {

struct FittedSkull {
  SurfaceMesh skull;               ///< scan frame, [mm]
  std::vector<double> depth;       ///< [mm] one per vertex of the scan; NaN where no bone
  std::vector<SkinRegion> region;  ///< one per vertex of the scan
  LandmarkSet landmarks;           ///< scan frame, [mm]
  std::vector<std::string> warnings;
};

/// As a GLB. Numbers are stored as 32-bit floats.
/// @throws InputError  a skull that is no surface, or a depth without a region
/// @throws FileError   cannot write; nothing is left under the name
void write_fit(const std::filesystem::path& path, const FittedSkull& fit);

}  // namespace palpate::io
