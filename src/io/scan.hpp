// SPDX-License-Identifier: Apache-2.0
// Scans in: OBJ, PLY (ascii, both binary orders), STL (ascii, binary), OFF, glTF and GLB.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "core/surface_mesh.hpp"
#include "core/units.hpp"

namespace palpate::io {

struct Scan {
  SurfaceMesh mesh;    ///< the file's vertices, all, in order, in the file's own numbers; polygons
                       ///< are split into fans; a glTF node's transform is applied; of a touchable
                       ///< head (io/head_file.hpp) the scan that it carries
  std::string format;  ///< "obj", "ply", "stl", "off", "gltf", "glb"
  double unit_mm = 0;  ///< [mm] in one unit, where the file says (a touchable head); else 0
  std::string sha256;  ///< of the file's bytes, lower-case hex; a .gltf's buffer files follow it
  std::vector<std::string> warnings;  ///< what is odd but can be used; one line each
};

/// @throws InputError  one line with the file, the first bad element and the remedy: empty,
/// truncated
///         at any byte, NaN or infinite, more than 20 M triangles, content that is not what the
///         extension says
[[nodiscard]] Scan read_scan(const std::filesystem::path& path);

struct UnitGuess {
  LengthUnit unit = LengthUnit::mm;
  bool certain = false;             ///< false where two units fit a head's size
  std::optional<LengthUnit> other;  ///< the next best, where it is possible at all
};
/// From the size of a head or bust. @throws InputError where no unit gives 120 to 1200 mm
[[nodiscard]] UnitGuess guess_unit(const SurfaceMesh& scan);

}  // namespace palpate::io
