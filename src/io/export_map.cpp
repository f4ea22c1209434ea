// SPDX-License-Identifier: Apache-2.0
// The map per user vertex, scan frame, mm. Decimals are the shortest that give the stored 32-bit
// float back.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/atomic_file.hpp"
#include "io/export.hpp"
#include "io/stiffness_colour.hpp"
#include "io/vtk_xml.hpp"

namespace palpate::io {
namespace {

using nlohmann::json;

float mm(const TouchableHead& head, std::size_t vertex, int axis) {
  return static_cast<float>(head.skin.points[vertex][axis] * head.unit_mm);
}

std::vector<float> column(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

template <typename Enum>
std::vector<std::uint8_t> codes(const std::vector<Enum>& values) {
  std::vector<std::uint8_t> out;
  for (const Enum v : values) out.push_back(static_cast<std::uint8_t>(v));
  return out;
}

std::vector<float> travel(const StiffnessMap& map, std::size_t sample) {
  std::vector<float> out(map.size());
  for (std::size_t v = 0; v < map.size(); ++v)
    out[v] = map.has_curve(v) ? static_cast<float>(map.curve(v)[sample])
                              : std::numeric_limits<float>::quiet_NaN();
  return out;
}

std::vector<float> stiffness(const StiffnessMap& map) {
  std::vector<float> out(map.size());
  for (std::size_t v = 0; v < map.size(); ++v)
    out[v] = static_cast<float>(secant_stiffness(map, v, kColourForce));
  return out;
}

json column_notes(const TouchableHead& head) {
  const StiffnessMap& map = head.map;
  json notes = json::array();
  const auto add = [&](const std::string& name, const char* unit, const std::string& meaning) {
    notes.push_back({{"name", name}, {"unit", unit}, {"meaning", meaning}});
  };
  add("vertex", "", "row of the scan's vertex, counted from 0, in the scan's order");
  for (const char* axis : {"x", "y", "z"}) add(axis, "mm", "position in the scan's own frame");
  add("region", "", "skin region");
  add("depth_mm", "mm", "distance from skin to bone; nan where no bone was found");
  add("status", "",
      "solved: pressed here; blended: from presses nearby; no_bone: no bone within "
      "reach; held: eye, nose or lips; failed: the solver did not converge; "
      "inverted, unsettled: the published recipe turns tissue inside out or does not come to rest, "
      "here or at the nearest site");
  add("error", "1", "estimated relative error of the travel; nan where there is none");
  for (std::size_t i = 1; i <= map.forces.size(); ++i)
    add(fmt::format("f_{}", i), "N", "force on the tool");
  for (std::size_t i = 1; i <= map.forces.size(); ++i)
    add(fmt::format("u_{}", i), "mm",
        fmt::format("travel of the tool along the inward normal from first contact, at f_{}; nan "
                    "where there is no curve",
                    i));
  if (!head.spread.empty()) {
    add("depth_sd_mm", "mm", "one standard deviation of depth_mm");
    add("stiffness_low", "N/mm", "lower end of the 95 % range of force / travel at 2 N");
    add("stiffness_high", "N/mm", "upper end");
  }
  if (!head.completed.empty())
    add("completed", "", "1: rests on skin that was completed, not scanned; else 0");
  return notes;
}

/// Ends of the stiffness' 95 % range: sign -2 the lower, 2 the upper one.
std::vector<float> stiffness_end(const TouchableHead& head, double sign) {
  std::vector<float> out(head.map.size());
  for (std::size_t v = 0; v < out.size(); ++v)
    out[v] = static_cast<float>(secant_stiffness(head.map, v, kColourForce) *
                                std::exp(sign * head.spread.stiffness[v]));
  return out;
}

}  // namespace

void write_map_csv(const std::filesystem::path& path, const TouchableHead& head) {
  const StiffnessMap& map = head.map;
  std::string out = "vertex,x,y,z,region,depth_mm,status,error";
  for (const char* prefix : {"f", "u"})
    for (std::size_t i = 1; i <= map.forces.size(); ++i) out += fmt::format(",{}_{}", prefix, i);
  std::vector<float> low, high;
  if (!head.spread.empty()) {
    out += ",depth_sd_mm,stiffness_low,stiffness_high";
    low = stiffness_end(head, -2), high = stiffness_end(head, 2);
  }
  if (!head.completed.empty()) out += ",completed";
  out += '\n';
  std::string forces;
  for (const double f : map.forces) forces += fmt::format(",{}", f);
  const auto to = std::back_inserter(out);
  const auto number = [&](double value) {  // without the sign that some NaNs carry
    std::isnan(value) ? fmt::format_to(to, ",nan")
                      : fmt::format_to(to, ",{}", static_cast<float>(value));
  };
  for (std::size_t v = 0; v < map.size(); ++v) {
    fmt::format_to(to, "{},{},{},{},{}", v, mm(head, v, 0), mm(head, v, 1), mm(head, v, 2),
                   name(map.region[v]));
    number(map.depth[v]);
    fmt::format_to(to, ",{}", name(map.status[v]));
    number(map.error[v]);
    out += forces;
    for (const double u : map.curve(v))
      number(map.has_curve(v) ? u : std::numeric_limits<double>::quiet_NaN());
    if (!head.spread.empty()) number(head.spread.depth[v]), number(low[v]), number(high[v]);
    if (!head.completed.empty()) out += head.completed[v] ? ",1" : ",0";
    out += '\n';
  }
  json sidecar;
  sidecar["columns"] = column_notes(head);
  sidecar["rows"] = map.size();
  sidecar["scan_unit_mm"] = head.unit_mm;
  sidecar["tool_radius_mm"] = map.tool_radius;
  sidecar["provenance"] = head.provenance;
  write_file(path.string() + ".json",
             sidecar.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  write_file(path, out);
}

void write_map_ply(const std::filesystem::path& path, const TouchableHead& head) {
  const StiffnessMap& map = head.map;
  const std::size_t samples = map.forces.size();
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment unit mm, frame of the scan\n";
  const auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < samples; ++i)
    fmt::format_to(to, "comment u_{} travel in mm at {} N\n", i + 1, map.forces[i]);
  for (const auto& [what, names] :
       {std::pair{"region", std::span<const std::string_view>(kSkinRegionNames)},
        std::pair{"status", std::span<const std::string_view>(kVertexStatusNames)}}) {
    fmt::format_to(to, "comment {}", what);
    for (std::size_t i = 0; i < names.size(); ++i) fmt::format_to(to, " {}={}", i, names[i]);
    out += '\n';
  }
  fmt::format_to(to,
                 "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "property uchar region\nproperty uchar status\nproperty float depth_mm\n"
                 "property float error\nproperty float stiffness\n",
                 map.size());
  for (std::size_t i = 1; i <= samples; ++i) fmt::format_to(to, "property float u_{}\n", i);
  if (!head.spread.empty())
    out +=
        "property float depth_sd_mm\nproperty float stiffness_low\nproperty float "
        "stiffness_high\n";
  if (!head.completed.empty()) out += "property uchar completed\n";
  fmt::format_to(to, "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                 head.skin.triangles.size());
  const auto put = [&out](auto value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  const StiffnessColours colours = stiffness_colours(map);
  const std::vector<float> secant = stiffness(map);
  std::vector<float> low, high;
  if (!head.spread.empty()) low = stiffness_end(head, -2), high = stiffness_end(head, 2);
  for (std::size_t v = 0; v < map.size(); ++v) {
    for (int k = 0; k < 3; ++k) put(mm(head, v, k));
    for (const std::uint8_t c : colours.colour[v]) put(c);
    put(static_cast<std::uint8_t>(map.region[v]));
    put(static_cast<std::uint8_t>(map.status[v]));
    put(static_cast<float>(map.depth[v]));
    put(static_cast<float>(map.error[v]));
    put(secant[v]);
    for (const double u : map.curve(v)) put(static_cast<float>(u));
    if (!head.spread.empty())
      put(static_cast<float>(head.spread.depth[v])), put(low[v]), put(high[v]);
    if (!head.completed.empty()) put(head.completed[v]);
  }
  for (const Triangle& t : head.skin.triangles) {
    put(std::uint8_t{3});
    for (const std::int32_t c : t) put(c);
  }
  write_file(path, out);
}

void write_map_vtp(const std::filesystem::path& path, const TouchableHead& head) {
  const StiffnessMap& map = head.map;
  VtkXml xml("PolyData");
  xml.line("<FieldData>");
  xml.line(
      fmt::format("<DataArray type=\"Float64\" Name=\"forces_n\" NumberOfTuples=\"{}\" "
                  "format=\"ascii\">{}</DataArray>",
                  map.forces.size(), fmt::join(map.forces, " ")));
  xml.line("</FieldData>");
  xml.line(
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                  "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">",
                  map.size(), head.skin.triangles.size()));
  xml.line("<PointData Scalars=\"stiffness\">");
  xml.array("stiffness", stiffness(map));
  xml.array("depth_mm", column(map.depth));
  xml.array("error", column(map.error));
  xml.array("region", codes(map.region));
  xml.array("status", codes(map.status));
  for (std::size_t i = 0; i < map.forces.size(); ++i)
    xml.array(fmt::format("u_{}", i + 1), travel(map, i));
  if (!head.spread.empty()) {
    xml.array("depth_sd_mm", column(head.spread.depth));
    xml.array("stiffness_low", stiffness_end(head, -2));
    xml.array("stiffness_high", stiffness_end(head, 2));
  }
  if (!head.completed.empty()) xml.array("completed", head.completed);
  xml.line("</PointData>");
  std::vector<float> points;
  for (std::size_t v = 0; v < map.size(); ++v)
    for (int k = 0; k < 3; ++k) points.push_back(mm(head, v, k));
  xml.line("<Points>");
  xml.array("points", points, 3);
  xml.line("</Points>");
  std::vector<std::int64_t> corners, ends;
  for (const Triangle& t : head.skin.triangles) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<std::int64_t>(corners.size()));
  }
  xml.line("<Polys>");
  xml.array("connectivity", corners);
  xml.array("offsets", ends);
  xml.line("</Polys>");
  xml.line("</Piece>");
  write_file(path, xml.finish());
}

}  // namespace palpate::io
