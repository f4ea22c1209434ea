// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/export.hpp"

namespace palpate::io {
namespace {

std::vector<Column> present(const SurfaceMesh& mesh, const std::vector<Column>& columns) {
  std::vector<Column> some;
  for (const Column& c : columns) {
    if (c.values.empty()) continue;
    if (c.values.size() != mesh.points.size())
      throw InputError(fmt::format("column '{}' has {} values for {} vertices", c.name,
                                   c.values.size(), mesh.points.size()));
    some.push_back(c);
  }
  return some;
}

}  // namespace

void write_columns_csv(const std::filesystem::path& path, const SurfaceMesh& mesh,
                       const std::vector<Column>& columns) {
  const std::vector<Column> all = present(mesh, columns);
  std::string out = "vertex,x,y,z";
  for (const Column& c : all) out += "," + c.name;
  out += '\n';
  const auto to = std::back_inserter(out);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const Vec3& p = mesh.points[v];
    fmt::format_to(to, "{},{},{},{}", v, static_cast<float>(p.x()), static_cast<float>(p.y()),
                   static_cast<float>(p.z()));
    for (const Column& c : all)
      std::isnan(c.values[v]) ? fmt::format_to(to, ",nan")
                              : fmt::format_to(to, ",{}", static_cast<float>(c.values[v]));
    out += '\n';
  }
  write_file(path, out);
}

void write_columns_ply(const std::filesystem::path& path, const SurfaceMesh& mesh,
                       const std::vector<Column>& columns) {
  const std::vector<Column> all = present(mesh, columns);
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment unit mm\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      mesh.points.size());
  for (const Column& c : all) out += "property float " + c.name + "\n";
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                     mesh.triangles.size());
  const auto put = [&out](auto value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(mesh.points[v][k]));
    for (const Column& c : all) put(static_cast<float>(c.values[v]));
  }
  for (const Triangle& t : mesh.triangles) {
    put(std::uint8_t{3});
    for (const std::int32_t c : t) put(c);
  }
  write_file(path, out);
}

}  // namespace palpate::io
