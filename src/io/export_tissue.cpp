// SPDX-License-Identifier: Apache-2.0
// Tetrahedra for other programs. Decimals are the shortest that give the double back.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/export.hpp"
#include "io/tissue_formats.hpp"
#include "io/vtk_xml.hpp"

namespace palpate::io {
namespace {

void check(const std::filesystem::path& path, const TissueMesh& mesh) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: not written: {}", path.string(), what));
  };
  const auto n = static_cast<std::int32_t>(mesh.nodes.size());
  if (mesh.tets.empty()) fail("the tissue has no tetrahedra");
  if (mesh.label.size() != mesh.tets.size()) fail("the tissue has not one label per tetrahedron");
  if (mesh.held.size() != mesh.nodes.size()) fail("the tissue has not one flag per node");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (!mesh.nodes[i].allFinite()) fail(fmt::format("node {} is not finite", i));
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const std::int32_t c : mesh.tets[t])
      if (c < 0 || c >= n) fail(fmt::format("tetrahedron {} refers to node {}", t, c));
}

/// Numbers from 1, `per_line` a line, as Abaqus and VEGA list sets.
template <typename Pick>
void list_numbers(std::string& out, std::size_t count, std::size_t per_line, Pick&& pick) {
  std::size_t in_line = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!pick(i)) continue;
    fmt::format_to(std::back_inserter(out), "{}{}", in_line == 0 ? "" : ", ", i + 1);
    if (++in_line == per_line) {
      out += '\n';
      in_line = 0;
    }
  }
  if (in_line > 0) out += '\n';
}

struct Material {
  const char* name;
  TissueLabel label;
  double density;         ///< [t/mm^3], which goes with mm, N, s, MPa
  double youngs_modulus;  ///< [MPa]
  double poisson_ratio;
};
// The published method's Table 4.2 (docs/method); VEGA demands a material for each set.
constexpr Material kMaterials[] = {{"FLESH", TissueLabel::flesh, 1.060e-9, 0.045658, 0.43},
                                   {"BONE", TissueLabel::bone, 1.421e-9, 6000, 0.22}};

}  // namespace

std::string tissue_vtu(const TissueMesh& mesh) {
  VtkXml xml("UnstructuredGrid");
  xml.line(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">", mesh.nodes.size(),
                       mesh.tets.size()));
  std::vector<std::uint8_t> skin(mesh.nodes.size());
  std::fill_n(skin.begin(), std::min(mesh.skin_points, skin.size()), std::uint8_t{1});
  xml.line("<PointData>");
  xml.array("held", mesh.held);
  xml.array("skin", skin);
  xml.line("</PointData>");
  std::vector<std::uint8_t> label;
  for (const TissueLabel l : mesh.label) label.push_back(static_cast<std::uint8_t>(l));
  xml.line("<CellData Scalars=\"label\">");
  xml.array("label", label);
  xml.line("</CellData>");
  std::vector<double> points;
  for (const Vec3& p : mesh.nodes) points.insert(points.end(), {p.x(), p.y(), p.z()});
  xml.line("<Points>");
  xml.array("points", points, 3);
  xml.line("</Points>");
  std::vector<std::int64_t> corners, ends;
  for (const Tetrahedron& t : mesh.tets) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  constexpr std::uint8_t kVtkTetra = 10;
  xml.line("<Cells>");
  xml.array("connectivity", corners);
  xml.array("offsets", ends);
  xml.array("types", std::vector<std::uint8_t>(mesh.tets.size(), kVtkTetra));
  xml.line("</Cells>");
  xml.line("</Piece>");
  return xml.finish();
}

std::string tissue_veg(const TissueMesh& mesh) {
  std::string out =
      fmt::format("# unit mm, N, s, MPa, t/mm^3\n\n*VERTICES\n{} 3 0 0\n", mesh.nodes.size());
  const auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    fmt::format_to(to, "{} {} {} {}\n", i + 1, mesh.nodes[i].x(), mesh.nodes[i].y(),
                   mesh.nodes[i].z());
  fmt::format_to(to, "\n*ELEMENTS\nTET\n{} 4 0\n", mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    fmt::format_to(to, "{} {} {} {} {}\n", t + 1, mesh.tets[t][0] + 1, mesh.tets[t][1] + 1,
                   mesh.tets[t][2] + 1, mesh.tets[t][3] + 1);
  for (const Material& m : kMaterials) {
    if (std::find(mesh.label.begin(), mesh.label.end(), m.label) == mesh.label.end()) continue;
    fmt::format_to(to, "\n*MATERIAL {}\nENU, {}, {}, {}\n", m.name, m.density, m.youngs_modulus,
                   m.poisson_ratio);
    fmt::format_to(to, "\n*SET {}\n", m.name);
    list_numbers(out, mesh.tets.size(), 8, [&](std::size_t t) { return mesh.label[t] == m.label; });
    fmt::format_to(to, "\n*REGION\n{}, {}\n", m.name, m.name);
  }
  return out;
}

std::string tissue_inp(const TissueMesh& mesh) {
  std::string out = "*HEADING\npalpate tissue mesh; mm, N, s, MPa\n*NODE, NSET=ALL\n";
  const auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    fmt::format_to(to, "{}, {}, {}, {}\n", i + 1, mesh.nodes[i].x(), mesh.nodes[i].y(),
                   mesh.nodes[i].z());
  for (const Material& m : kMaterials) {
    if (std::find(mesh.label.begin(), mesh.label.end(), m.label) == mesh.label.end()) continue;
    fmt::format_to(to, "*ELEMENT, TYPE=C3D4, ELSET={}\n", m.name);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
      if (mesh.label[t] == m.label)
        fmt::format_to(to, "{}, {}, {}, {}, {}\n", t + 1, mesh.tets[t][0] + 1, mesh.tets[t][1] + 1,
                       mesh.tets[t][2] + 1, mesh.tets[t][3] + 1);
  }
  const auto node_set = [&](const char* name, auto&& pick) {
    std::string numbers;
    list_numbers(numbers, mesh.nodes.size(), 16, pick);
    if (!numbers.empty()) fmt::format_to(to, "*NSET, NSET={}\n{}", name, numbers);
  };
  node_set("SKIN", [&](std::size_t i) { return i < mesh.skin_points; });
  node_set("HELD", [&](std::size_t i) { return mesh.held[i] != 0; });
  return out;
}

void write_tissue(const std::filesystem::path& path, const TissueMesh& mesh) {
  const std::string extension = path.extension().string();
  check(path, mesh);
  if (extension == ".vtu")
    write_file(path, tissue_vtu(mesh));
  else if (extension == ".veg")
    write_file(path, tissue_veg(mesh));
  else if (extension == ".inp")
    write_file(path, tissue_inp(mesh));
  else if (extension == ".msh")
    write_file(path, tissue_msh(mesh));
  else
    throw InputError(fmt::format("{}: tissue is written as .vtu, .veg, .inp or .msh; choose one",
                                 path.string()));
}

}  // namespace palpate::io
