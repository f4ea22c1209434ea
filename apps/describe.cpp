// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/landmark_text.hpp"
#include "apps/tissue_file.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "report/summary.hpp"
#include "report/verdict.hpp"

namespace palpate::app {
using nlohmann::json;

static json vector_json(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
/// JSON has no NaN: null.
static json number(double x) {
  return std::isfinite(x) ? json(x) : json(nullptr);
}

json describe(const PipelineOptions& o) {
  const bool published = o.sweep.mode == stiffness::SweepMode::published;
  json given = json::object();
  for (const auto& [name, p] : o.landmarks.given) given[name] = vector_json(p);
  return {
      {"edge_mm", o.repair.target_edge},
      {"landmarks", o.landmarks.method == landmarks::Method::published ? "published" : "robust"},
      {"landmarks_given", given},
      {"fit", o.fit.method == skull::Method::published ? "published" : "depth"},
      {"clearance_mm", o.fit.clearance},
      {"template", o.skull_template.filename().string()},
      {"depths", o.depth_table.filename().string()},
      {"own_skull", o.own_skull.filename().string()},
      {"ct", o.ct.filename().string()},
      {"labels", o.labels.filename().string()},
      {"skin_threshold_hu", o.image.skin_threshold},
      {"bone_threshold_hu", o.image.bone_threshold},
      {"image_smoothing_mm", o.image.smoothing},
      {"image_voxel_mm", o.image.voxel},
      {"bone_labels", o.image.bone_labels},
      {"tissue_max_volume_mm3", o.tissue.max_volume},
      {"tool_radius_mm", o.sweep.tool_radius},
      {"preset", published ? "published" : "default"},
      {"mode", published                                     ? "published"
               : o.sweep.mode == stiffness::SweepMode::exact ? "exact"
                                                             : "fast"},
      {"published_reach_mm", published ? json(o.sweep.published.reach) : json(nullptr)},
      {"tissue_model", describe(o.sweep.tissue)},
      {"organs", o.sweep.organs.organs == stiffness::Organs::held ? "held" : "supported"},
      {"organ_give_mm_per_n", o.sweep.organs.give},
      {"loads", o.sweep.loads},
      {"max_force_n", o.sweep.max_force},
      {"sites", o.sweep.sites},
      {"error_bound", o.sweep.error_bound},
      {"no_bone_beyond_mm", o.sweep.no_bone_beyond},
      {"modulus_spread", o.spread.modulus_spread},
      {"seed", o.sweep.seed},
  };
}

json describe(const surface::RepairReport& r) {
  return {{"duplicate_points", r.duplicate_points},
          {"duplicate_faces", r.duplicate_faces},
          {"degenerate_faces", r.degenerate_faces},
          {"nonmanifold_spots", r.nonmanifold_spots},
          {"components", r.components},
          {"dropped_triangles", r.dropped_triangles},
          {"winding_inverted", r.winding_inverted},
          {"holes_filled", r.holes_filled},
          {"largest_hole_mm", r.largest_hole_mm},
          {"decimated_from", r.decimated_from},
          {"wrapped", r.wrapped},
          {"deviation_p95_mm", r.deviation_p95_mm},
          {"lines", r.lines}};
}

json describe(const LandmarkSet& landmarks, double unit_mm) {
  json all = json::object();
  for (const auto& [name, mark] : landmarks)
    all[name] = {{"position", vector_json(mark.position / unit_mm)},
                 {"confidence", mark.confidence}};
  return all;
}

json describe(const std::vector<DepthRow>& depths) {
  json rows = json::array();
  for (const DepthRow& d : depths)
    rows.push_back({{"code", d.code},
                    {"published_mm", d.published_mm},
                    {"sd_mm", d.sd_mm > 0 ? json(d.sd_mm) : json(nullptr)},
                    {"depth_mm", number(d.depth_mm)},
                    {"reached", d.reached}});
  return rows;
}

json describe(const std::vector<stiffness::PublishedSite>& sites) {
  json out = json::array();
  for (const stiffness::PublishedSite& s : sites) {
    json site = {{"vertex", s.point},
                 {"u_mm", json::array()},
                 {"inverted_tets", json::array()},
                 {"at_rest", json::array()},
                 {"steps", json::array()}};
    for (const fem::PublishedSample& p : s.samples) {
      site["u_mm"].push_back(number(p.displacement));
      site["inverted_tets"].push_back(p.inverted_tets);
      site["at_rest"].push_back(p.at_rest);
      site["steps"].push_back(p.steps);
    }
    out.push_back(site);
  }
  return out;
}

json describe(const HeadFrame& frame) {
  json rows = json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(vector_json(frame.rotation.row(i).transpose()));
  return {{"rotation", rows}, {"origin_mm", vector_json(frame.origin)}};
}

/// Share of the table's landmarks with an SD that lie within 1.5 SD.
static json describe(const report::DepthAgreement& depths) {
  const double share = static_cast<double>(depths.within) / static_cast<double>(depths.compared);
  return {{"landmarks_with_sd", depths.compared},
          {"within_1_5_sd", depths.within},
          {"share", depths.compared > 0 ? json(share) : json(nullptr)}};
}

json describe(const TouchableHead& head) {
  json status = json::object();
  for (const auto n : kVertexStatusNames) status[std::string(n)] = 0;
  for (const VertexStatus s : head.map.status)
    status[std::string(name(s))] = status[std::string(name(s))].get<int>() + 1;
  return {{"vertices", head.skin.points.size()},
          {"triangles", head.skin.triangles.size()},
          {"skull_vertices", head.skull.points.size()},
          {"unit_mm", head.unit_mm},
          {"units", {{"length", "mm"}, {"force", "N"}, {"stiffness", "N/mm"}}},
          {"frame", describe(head.frame)},
          {"landmarks", describe(head.landmarks, head.unit_mm)},
          {"depths", describe(head.depths)},
          {"depth_agreement", describe(report::depth_agreement(head.depths))},
          {"tool_radius_mm", head.map.tool_radius},
          {"forces_n", head.map.forces},
          {"status", status},
          {"completed", std::count(head.completed.begin(), head.completed.end(), 1)},
          {"regions", report::to_json(report::region_summary(head))},
          {"provenance", head.provenance},
          {"run", head.run}};
}

std::map<std::string, Vec3> read_landmark_file(const std::filesystem::path& path) {
  std::map<std::string, Vec3> given;
  const std::string text = read_file(path);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != text.npos && text[first] != '{') return parse_landmark_text(text, path.string());
  try {
    const json file = json::parse(text);
    for (const auto& [name, mark] : file.at("landmarks").items()) {
      const json& p = mark.at("position");
      given[name] = Vec3(p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
    }
  } catch (const json::exception& error) {
    throw InputError(
        fmt::format("{}: not a landmark file ({}); write one with `palpate landmarks SCAN --json`",
                    path.string(), error.what()));
  }
  return given;
}

}  // namespace palpate::app
