// SPDX-License-Identifier: Apache-2.0
// The skull: as a template, and as fitted into one head.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/landmarks.hpp"
#include "core/regions.hpp"
#include "core/surface_mesh.hpp"

namespace palpate {

/// A craniometric point on bone. Keys are the codes of the depth table ("g", "n", "zy_left", ...):
/// midline points as the plain code, paired ones with _left or _right.
struct SkullLandmark {
  Vec3 position = Vec3::Zero();  ///< [mm] on the bone's surface
  Vec3 normal = Vec3::Zero();    ///< [-] unit, out of the bone
};

/// Closed, oriented outer hull of a skull in its own head frame (Frankfurt plane horizontal, origin
/// midway between the porions), [mm].
struct SkullTemplate {
  std::string name;
  SurfaceMesh mesh;
  std::vector<SkullRegion> region;                  ///< one per point of the mesh
  std::map<std::string, SkullLandmark> landmarks;   ///< by code of the depth table
  std::map<std::string, Vec3> registration_points;  ///< where the skin's landmarks lie, by name
};

/// One row of the published soft-tissue depth table.
struct TissueDepth {
  std::string code;  ///< without side
  std::string landmark;
  double mean_mm = 0;
  double sd_mm = 0;  ///< 0 where the source gives none
  std::string source;
};

/// Depth found at one landmark, beside the published one.
struct DepthRow {
  std::string code;  ///< with side
  double published_mm = 0;
  double sd_mm = 0;      ///< 0 where the source gives none
  double depth_mm = 0;   ///< from the bone's landmark to the skin; NaN where the scan has no skin
  bool reached = false;  ///< false where the scan ends before the landmark
};

/// A skull inside a head; head frame, [mm].
struct SkullFit {
  SurfaceMesh mesh;                                ///< closed where the template is, or clipped
  std::vector<SkullRegion> region;                 ///< one per point of the mesh
  std::map<std::string, SkullLandmark> landmarks;  ///< moved with the mesh
  std::vector<DepthRow> depths;
  std::map<std::string, double> statistics;  ///< named figures of the fit, units in the names
  std::vector<std::string> warnings;
  /// [mm] one per point: standard deviation of where the bone really lies, along the shortest way
  /// to the skin. Empty where it is not estimated (a skull that was measured).
  std::vector<double> spread;
  /// Skulls that are as probable as the spread says: places of the same points, [mm]. For what
  /// depends on the skull in more than one place. Empty as `spread` is.
  std::vector<std::vector<Vec3>> draws;
};

}  // namespace palpate
