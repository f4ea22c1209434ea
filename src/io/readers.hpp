// SPDX-License-Identifier: Apache-2.0
// The readers behind read_scan: pure functions of a Source. All throw InputError.
#pragma once
#include <string>
#include <vector>

#include "core/surface_mesh.hpp"
#include "io/source.hpp"

namespace palpate::io {

/// What a reader found: all vertices in file order, polygons as fans.
struct ParsedMesh {
  SurfaceMesh mesh;
  std::vector<std::string> warnings;
  std::vector<double> property;       ///< the asked-for vertex property (PLY only), one per vertex
  std::vector<std::string> external;  ///< contents of files that the file names (glTF only)
  double unit_mm = 0;                 ///< [mm] in one unit, where the file says (a touchable head)
};

[[nodiscard]] ParsedMesh parse_obj(const Source& source);
/// @param property  a scalar vertex property to return as well; required where not empty
[[nodiscard]] ParsedMesh parse_ply(const Source& source, const std::string& property = {});
[[nodiscard]] ParsedMesh parse_stl(const Source& source);
[[nodiscard]] ParsedMesh parse_off(const Source& source);
[[nodiscard]] ParsedMesh parse_gltf(const Source& source);
[[nodiscard]] ParsedMesh parse_glb(const Source& source);

}  // namespace palpate::io
