// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/export.hpp"

namespace palpate::io {
namespace {

template <typename T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

bool fits_float(const SurfaceMesh& mesh) {
  return std::all_of(mesh.points.begin(), mesh.points.end(),
                     [](const Vec3& p) { return p == p.cast<float>().cast<double>(); });
}

/// Coordinates are floats where that loses nothing, doubles otherwise.
std::string ply(const SurfaceMesh& mesh) {
  const bool single = fits_float(mesh);
  const char* type = single ? "float" : "double";
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property {} x\nproperty {} y\nproperty {} z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.points.size(), type, type, type, mesh.triangles.size());
  for (const Vec3& p : mesh.points)
    for (int k = 0; k < 3; ++k) single ? append(out, static_cast<float>(p[k])) : append(out, p[k]);
  for (const Triangle& t : mesh.triangles) {
    append(out, std::uint8_t{3});
    for (const std::int32_t c : t) append(out, c);
  }
  return out;
}

std::string stl(const SurfaceMesh& mesh) {
  if (mesh.triangles.size() > 0xffffffffu) throw InputError("too many triangles for STL");
  std::string out = "binary STL written by palpate";
  out.resize(80, ' ');
  append(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  const std::vector<Vec3> normals = triangle_normals(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto vector = [&](const Vec3& v) {
      for (int k = 0; k < 3; ++k) append(out, static_cast<float>(v[k]));
    };
    vector(normals[t]);
    for (const std::int32_t c : mesh.triangles[t]) vector(mesh.points[c]);
    append(out, std::uint16_t{0});
  }
  return out;
}

/// Decimals are the shortest that give the double back.
std::string obj(const SurfaceMesh& mesh) {
  std::string out = "# written by palpate\n";
  for (const Vec3& p : mesh.points)
    fmt::format_to(std::back_inserter(out), "v {} {} {}\n", p.x(), p.y(), p.z());
  for (const Triangle& t : mesh.triangles)
    fmt::format_to(std::back_inserter(out), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

std::string off(const SurfaceMesh& mesh) {
  std::string out = fmt::format("OFF\n{} {} 0\n", mesh.points.size(), mesh.triangles.size());
  for (const Vec3& p : mesh.points)
    fmt::format_to(std::back_inserter(out), "{} {} {}\n", p.x(), p.y(), p.z());
  for (const Triangle& t : mesh.triangles)
    fmt::format_to(std::back_inserter(out), "3 {} {} {}\n", t[0], t[1], t[2]);
  return out;
}

}  // namespace

void write_surface(const std::filesystem::path& path, const SurfaceMesh& mesh) {
  const std::string extension = path.extension().string();
  if (const auto defect = first_defect(mesh))
    throw InputError(fmt::format("{}: not written: {}", path.string(), *defect));
  if (extension == ".ply")
    write_file(path, ply(mesh));
  else if (extension == ".stl")
    write_file(path, stl(mesh));
  else if (extension == ".obj")
    write_file(path, obj(mesh));
  else if (extension == ".off")
    write_file(path, off(mesh));
  else
    throw InputError(fmt::format("{}: a surface is written as .ply, .stl, .obj or .off; choose one",
                                 path.string()));
}

}  // namespace palpate::io
