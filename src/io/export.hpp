// SPDX-License-Identifier: Apache-2.0
// Meshes and maps out, for Blender, ParaView, MeshLab, VEGA, Abaqus/CalculiX, Gmsh and
// spreadsheets.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "core/skull.hpp"
#include "core/tissue_mesh.hpp"
#include "core/touchable_head.hpp"

namespace palpate::io {

/// Bare mesh as PLY (binary little-endian), STL, OBJ or OFF, by the extension.
void write_surface(const std::filesystem::path& path, const SurfaceMesh& mesh);
/// One row per vertex in input order, scan frame, mm: vertex,x,y,z,region,depth_mm,status,error,
/// f_1..f_n,u_1..u_n, and, where the spread is known,
/// depth_sd_mm,stiffness_low,stiffness_high, and completed of a completed face; a JSON sidecar
/// `<path>.json` says what each column is.
void write_map_csv(const std::filesystem::path& path, const TouchableHead& head);
/// Skin in mm, scan frame, with the map as vertex properties.
void write_map_ply(const std::filesystem::path& path, const TouchableHead& head);
void write_map_vtp(const std::filesystem::path& path, const TouchableHead& head);
/// A named number per vertex; an empty one is left out.
struct Column {
  std::string name;
  std::span<const double> values;
};
/// vertex,x,y,z and the columns; a NaN is written as nan.
void write_columns_csv(const std::filesystem::path& path, const SurfaceMesh& mesh,
                       const std::vector<Column>& columns);
/// Binary little-endian, the columns as float properties.
void write_columns_ply(const std::filesystem::path& path, const SurfaceMesh& mesh,
                       const std::vector<Column>& columns);
/// Tetrahedra with labels by the extension: .vtu, .veg (VEGA FEM), .inp (Abaqus, CalculiX), .msh
/// (Gmsh 2.2).
void write_tissue(const std::filesystem::path& path, const TissueMesh& mesh);
/// Reads what write_tissue wrote as .msh.
[[nodiscard]] TissueMesh read_tissue(const std::filesystem::path& msh);

}  // namespace palpate::io
