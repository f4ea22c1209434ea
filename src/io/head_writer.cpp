// SPDX-License-Identifier: Apache-2.0
// docs/formats.md describes the layout; head_reader.cpp is the way back.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/glb_writer.hpp"
#include "io/head_file.hpp"
#include "io/stiffness_colour.hpp"

namespace palpate::io {
namespace {

using json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& what) {
  throw InputError(fmt::format("touchable head: {}; nothing was written", what));
}

void check_map(const TouchableHead& head) {
  const std::size_t n = head.skin.points.size(), samples = head.map.forces.size();
  const StiffnessMap& map = head.map;
  if (head.skin.empty()) refuse("the skin has no triangles");
  if (samples == 0) refuse("no forces");
  if (map.status.size() != n || map.error.size() != n || map.depth.size() != n ||
      map.region.size() != n || map.displacement.size() != n * samples ||
      (!map.method.empty() && map.method.size() != n) ||
      map.dents.share.size() != n * map.dents.radii.size())
    refuse(fmt::format("the map has not one row for each of the {} vertices", n));
  for (std::size_t v = 0; v < n && !map.dents.radii.empty(); ++v)
    for (std::size_t r = 0; r < map.dents.radii.size() && map.has_curve(v); ++r)
      if (!std::isfinite(map.dents.share[v * map.dents.radii.size() + r]))
        refuse(fmt::format("vertex {}: its dent is not finite", v));
  for (const std::vector<double>* column : {&head.spread.depth, &head.spread.stiffness})
    if (column->size() != (head.spread.empty() ? 0 : n))
      refuse(fmt::format("the spread has not one row for each of the {} vertices", n));
  if (!head.completed.empty() && head.completed.size() != n)
    refuse(fmt::format("the marks of completed skin are not one for each of the {} vertices", n));
  if (!head.skull_spread.empty() && head.skull_spread.size() != head.skull.points.size())
    refuse("the skull's spread has not one row for each of its vertices");
  if (head.skull_region.size() != head.skull.points.size())
    refuse("the skull has not one region per vertex");
  for (const SurfaceMesh* mesh : {&head.skin, &head.skull})
    if (const auto defect = first_defect(*mesh)) refuse(*defect);
  for (std::size_t v = 0; v < n; ++v) {
    float before = 0;  // as stored: equal floats would be a vertical piece
    for (const double u : map.curve(v)) {
      if (!map.has_curve(v)) break;
      const auto stored = static_cast<float>(u);
      if (!(stored > before) || !std::isfinite(stored))
        refuse(fmt::format("vertex {}: its curve does not ascend", v));
      before = stored;
    }
  }
}

std::vector<float> float_points(const std::vector<Vec3>& points) {
  std::vector<float> out = glb_vectors(points);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!std::isfinite(out[i]))
      refuse(fmt::format("a coordinate {} is too large", points[i / 3][static_cast<int>(i % 3)]));
  return out;
}

template <typename Values, typename Function>
std::vector<float> floats(const Values& values, Function&& convert) {
  std::vector<float> out;
  out.reserve(values.size());
  for (const auto& v : values) out.push_back(convert(v));
  return out;
}

json skin_attributes(GlbWriter& glb, const TouchableHead& head, const StiffnessColours& colours) {
  const StiffnessMap& map = head.map;
  json attributes;
  attributes["POSITION"] = glb.add_floats(float_points(head.skin.points), 3, true);
  attributes["NORMAL"] = glb.add_floats(glb_normals(head.skin), 3);
  std::vector<std::uint8_t> rgba;
  rgba.reserve(4 * map.size());
  for (const Rgb& colour : colours.colour) {
    for (const std::uint8_t c : colour)
      rgba.push_back(static_cast<std::uint8_t>(std::lround(255 * linear_light(c))));
    rgba.push_back(255);
  }
  attributes["COLOR_0"] = glb.add_colours(rgba);
  const auto code = [](auto v) { return static_cast<float>(static_cast<int>(v)); };
  attributes["_DEPTH"] = glb.add_floats(floats(map.depth, glb_or_missing), 1);
  attributes["_ERROR"] = glb.add_floats(floats(map.error, glb_or_missing), 1);
  attributes["_STATUS"] = glb.add_floats(floats(map.status, code), 1);
  attributes["_REGION"] = glb.add_floats(floats(map.region, code), 1);
  if (!map.method.empty()) attributes["_METHOD"] = glb.add_floats(floats(map.method, code), 1);
  if (!head.spread.empty()) {
    attributes["_DEPTH_SD"] = glb.add_floats(floats(head.spread.depth, glb_or_missing), 1);
    attributes["_STIFFNESS_SD"] = glb.add_floats(floats(head.spread.stiffness, glb_or_missing), 1);
  }
  if (!head.completed.empty())
    attributes["_COMPLETED"] = glb.add_floats(floats(head.completed, code), 1);
  for (std::size_t r = 0; r < map.dents.radii.size(); ++r) {
    std::vector<float> ring;
    for (std::size_t v = 0; v < map.size(); ++v)
      ring.push_back(map.has_curve(v)
                         ? static_cast<float>(map.dents.share[v * map.dents.radii.size() + r])
                         : 0.0f);
    attributes[fmt::format("_DENT_{}", r + 1)] = glb.add_floats(ring, 1);
  }

  const std::size_t n = map.size(), samples = map.forces.size();
  std::vector<std::vector<float>> u(samples, std::vector<float>(n, -1)), k(samples), b(samples);
  for (std::size_t i = 0; i < samples; ++i) k[i].assign(n, 0), b[i].assign(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    if (!map.has_curve(v)) continue;
    const StiffnessCoefficients c = stiffness_coefficients(map.forces, map.curve(v));
    for (std::size_t i = 0; i < samples; ++i) {
      u[i][v] = static_cast<float>(map.curve(v)[i]);
      k[i][v] = static_cast<float>(c.k[i]);
      b[i][v] = static_cast<float>(c.b[i]);
    }
  }
  const std::pair<const char*, const std::vector<std::vector<float>>*> tables[] = {
      {"_U_", &u}, {"_K_", &k}, {"_B_", &b}};
  for (const auto& [prefix, table] : tables)
    for (std::size_t i = 0; i < samples; ++i)
      attributes[fmt::format("{}{}", prefix, i + 1)] = glb.add_floats((*table)[i], 1);
  return attributes;
}

json primitive(GlbWriter& glb, const json& attributes, const SurfaceMesh& mesh, int material) {
  return {{"attributes", attributes},
          {"indices", glb.add_indices(glb_corners(mesh))},
          {"material", material}};
}

json numbers(const Vec3& v) {
  return json::array({v.x(), v.y(), v.z()});
}

/// Scan numbers times `unit_mm`, into the head frame, in metres: glTF's +Y up and +Z front.
json node(const char* name, std::size_t mesh, const HeadFrame& frame, double unit_mm) {
  constexpr double kMetresPerMm = 0.001;
  const Vec3 shift = -kMetresPerMm * (frame.rotation * frame.origin);
  const Eigen::Quaterniond q = Eigen::Quaterniond(frame.rotation).normalized();
  const double scale = kMetresPerMm * unit_mm;
  return {{"name", name},
          {"mesh", mesh},
          {"translation", numbers(shift)},
          {"rotation", {q.x(), q.y(), q.z(), q.w()}},
          {"scale", {scale, scale, scale}}};
}

json material(const char* name, std::array<double, 3> linear_colour, double roughness) {
  return {{"name", name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {linear_colour[0], linear_colour[1], linear_colour[2], 1.0}},
            {"metallicFactor", 0.0},
            {"roughnessFactor", roughness}}},
          {"doubleSided", true}};
}

json extension(const TouchableHead& head, const StiffnessColours& colours) {
  json out;
  out["version"] = kHeadFormatVersion;
  out["unit_mm"] = head.unit_mm;
  out["tool_radius_mm"] = head.map.tool_radius;
  out["forces_n"] = head.map.forces;
  out["missing"] = -1;
  out["status_names"] = kVertexStatusNames;
  if (!head.map.method.empty()) out["method_names"] = kSolveMethodNames;
  if (!head.map.dents.radii.empty())
    out["dents"] = {{"force_n", head.map.dents.force}, {"radii_mm", head.map.dents.radii}};
  if (!head.spread.empty())
    out["spread"] = {{"depth", "one standard deviation [mm]"},
                     {"stiffness", "one standard deviation of ln(force / travel) at force_n"},
                     {"force_n", kColourForce}};
  if (!head.completed.empty())
    out["completed"] = "1: rests on skin that was completed, not scanned";
  out["skin_region_names"] = kSkinRegionNames;
  out["skull_region_names"] = kSkullRegionNames;
  out["colour"] = {{"quantity", "force / travel"}, {"force_n", kColourForce}, {"unit", "N/mm"},
                   {"scale", "logarithmic"},       {"palette", "viridis"},    {"low", colours.low},
                   {"high", colours.high}};
  const Mat3& r = head.frame.rotation;
  out["frame"] = {
      {"rotation", json::array({numbers(r.row(0)), numbers(r.row(1)), numbers(r.row(2))})},
      {"origin_mm", numbers(head.frame.origin)}};
  out["landmarks"] = json::object();
  for (const auto& [name, mark] : head.landmarks)
    out["landmarks"][name] = {{"position_mm", numbers(mark.position)},
                              {"confidence", mark.confidence}};
  out["depths"] = json::array();
  for (const DepthRow& d : head.depths)  // a NaN is written as null
    out["depths"].push_back({{"code", d.code},
                             {"published_mm", d.published_mm},
                             {"sd_mm", d.sd_mm},
                             {"depth_mm", d.depth_mm},
                             {"reached", d.reached}});
  out["provenance"] = head.provenance;
  out["run"] = head.run.is_null() ? nlohmann::json::object() : head.run;
  return out;
}

}  // namespace

std::string head_bytes(const TouchableHead& head) {
  check_map(head);
  const StiffnessColours colours = stiffness_colours(head.map);
  GlbWriter glb;
  json nodes = json::array({node("skin", 0, head.frame, head.unit_mm)});
  json meshes = json::array();
  json materials = json::array({material("skin", {1, 1, 1}, 0.8)});
  const json attributes = skin_attributes(glb, head, colours);
  meshes.push_back(
      {{"name", "skin"}, {"primitives", json::array({primitive(glb, attributes, head.skin, 0)})}});
  if (!head.skull.empty()) {
    json bone;
    bone["POSITION"] = glb.add_floats(float_points(head.skull.points), 3, true);
    bone["NORMAL"] = glb.add_floats(glb_normals(head.skull), 3);
    bone["_REGION"] = glb.add_floats(
        floats(head.skull_region, [](SkullRegion r) { return static_cast<float>(r); }), 1);
    if (!head.skull_spread.empty())
      bone["_DEPTH_SD"] = glb.add_floats(floats(head.skull_spread, glb_or_missing), 1);
    meshes.push_back(
        {{"name", "skull"}, {"primitives", json::array({primitive(glb, bone, head.skull, 1)})}});
    nodes.push_back(node("skull", 1, head.frame, 1.0));
    materials.push_back(material("bone", {0.79, 0.70, 0.53}, 0.9));
  }
  json document;
  document["asset"] = {{"version", "2.0"}, {"generator", fmt::format("palpate {}", kVersion)}};
  document["extensionsUsed"] = json::array({kHeadExtension});
  document["scene"] = 0;
  json roots = json::array();
  for (std::size_t i = 0; i < nodes.size(); ++i) roots.push_back(i);
  document["scenes"] = json::array({{{"name", "head"}, {"nodes", roots}}});
  document["nodes"] = nodes;
  document["meshes"] = meshes;
  document["materials"] = materials;
  document["extensions"][kHeadExtension] = extension(head, colours);
  return glb.finish(std::move(document));
}

void write_head(const std::filesystem::path& path, const TouchableHead& head) {
  write_file(path, head_bytes(head));
}

}  // namespace palpate::io
