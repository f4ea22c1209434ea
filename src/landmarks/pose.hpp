// SPDX-License-Identifier: GPL-3.0-or-later
// A face in a scan: pose, size and shape of the statistical face that lies best on the surface.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "landmarks/face_model.hpp"
#include "landmarks/skin.hpp"

namespace palpate::landmarks {

/// scan = scale * rotation * model + translation; the columns of `rotation` are the head's axes.
struct FacePose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();  ///< [mm]
  double scale = 1;                 ///< [-] size against the mean adult
  FaceModel::Coefficients shape{};  ///< [SD], and how far the mouth is open

  [[nodiscard]] Vec3 to_scan(const Vec3& model) const {
    return scale * (rotation * model) + translation;
  }
};

/// How well a pose explains the surface, over one part of the model.
struct PartFit {
  double mean_distance = 10;  ///< [mm] to the surface, each at most 10 (also where it faces away)
  double agreement = 0;       ///< [-] mean cosine between model and surface normals, 1 is perfect
  double outliers = 1;        ///< [-] share of points more than 6 mm away or facing elsewhere
  [[nodiscard]] double cost() const { return mean_distance + 6 * (1 - agreement); }  ///< [mm]
};
struct FaceFit {
  PartFit core;   ///< eyes, brows, nose and what lies between: every scan must have them
  PartFit lower;  ///< upper lip to chin: missing where a scan ends at the mouth
  PartFit vault;  ///< forehead to crown, under hair or missing in some scans
  /// [mm] what hypotheses are compared by: distance and direction of the core; the lower face and
  /// the vault count up to a limit, so that a scan may end above the chin.
  [[nodiscard]] double cost() const;
  [[nodiscard]] bool has_lower_face() const { return lower.outliers < 0.4; }
};

/// Named points that the user gave, [mm] in the scan; they pull the model with kPinWeight.
using Pins = std::map<std::string, Vec3>;

struct FitSchedule {
  int iterations = 10;
  int stride = 1;           ///< every n-th pair of model points is used
  bool with_shape = false;  ///< solve for the modes as well, but for the mouth's
  bool with_mouth = false;  ///< and for that
  bool with_scale = true;
  double tolerance_mm = 4.0;  ///< [mm] distance at which a point's weight has dropped to a quarter
  double reach_mm = 1e9;      ///< [mm] a model point with no surface this near has no say
};

/// Iterated closest points, point to plane, with robust weights and the population's prior.
/// @param pins  keys that the model does not know are ignored
[[nodiscard]] FacePose fit_pose(const Skin& skin, FacePose pose, const FitSchedule& schedule,
                                const Pins& pins = {});
[[nodiscard]] FaceFit judge(const Skin& skin, const FacePose& pose, int stride = 1);

/// Candidate nose tips: the strongest domes. Indices of the skin's points, best first.
[[nodiscard]] std::vector<int> dome_points(const Skin& skin, int at_most);

/// The best pose over all domes, directions and rolls.
struct FaceSearch {
  FacePose pose;
  FaceFit fit;
  FaceFit rival;  ///< the best pose that differs by more than 20 degrees or 20 mm
};
/// @param pins  the user's own points; nose_tip replaces the search for domes
/// @throws InputError  where nothing looks like a nose
[[nodiscard]] FaceSearch search_face(const Skin& skin, const Pins& pins, const Progress& progress);

}  // namespace palpate::landmarks
