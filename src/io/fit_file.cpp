// SPDX-License-Identifier: Apache-2.0
#include "io/fit_file.hpp"

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/glb_writer.hpp"

namespace palpate::io {
namespace {

using nlohmann::ordered_json;

ordered_json skin_attributes(GlbWriter& glb, const FittedSkull& fit) {
  std::vector<float> depth, region;
  for (const double d : fit.depth) depth.push_back(glb_or_missing(d));
  for (const SkinRegion r : fit.region) region.push_back(static_cast<float>(r));
  return {{"_DEPTH", glb.add_floats(depth, 1)}, {"_REGION", glb.add_floats(region, 1)}};
}

ordered_json facts(const FittedSkull& fit) {
  ordered_json marks = ordered_json::object();
  for (const auto& [name, mark] : fit.landmarks)
    marks[name] = {{"position_mm", {mark.position.x(), mark.position.y(), mark.position.z()}},
                   {"confidence", mark.confidence}};
  return {{"landmarks", marks}, {"warnings", fit.warnings}};
}

}  // namespace

void write_fit(const std::filesystem::path& path, const FittedSkull& fit) {
  if (const auto defect = first_defect(fit.skull)) throw InputError("the skull: " + *defect);
  if (fit.depth.size() != fit.region.size())
    throw InputError("the depths have not one region each");
  GlbWriter glb;
  const ordered_json bone = {{"POSITION", glb.add_floats(glb_vectors(fit.skull.points), 3, true)},
                             {"NORMAL", glb.add_floats(glb_normals(fit.skull), 3)}};
  const ordered_json skull = {{"attributes", bone},
                              {"indices", glb.add_indices(glb_corners(fit.skull))}};
  const ordered_json skin = {{"attributes", skin_attributes(glb, fit)}};
  ordered_json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "palpate"}};
  document["scene"] = 0;
  document["scenes"] = ordered_json::array({{{"nodes", {0}}}});
  document["nodes"] =
      ordered_json::array({{{"name", "skull"}, {"mesh", 0}, {"scale", {0.001, 0.001, 0.001}}}});
  document["meshes"] =
      ordered_json::array({{{"name", "skull"}, {"primitives", ordered_json::array({skull})}},
                           {{"name", "skin"}, {"primitives", ordered_json::array({skin})}}});
  document["extras"] = {{"palpate_fit", facts(fit)}};
  write_file(path, glb.finish(std::move(document)));
}

}  // namespace palpate::io
