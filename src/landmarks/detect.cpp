// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/detect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.hpp"
#include "landmarks/complete.hpp"
#include "landmarks/pose.hpp"
#include "landmarks/published.hpp"
#include "landmarks/sharpen.hpp"
#include "landmarks/verify.hpp"

namespace palpate::landmarks {
namespace {

// The points of the contract are always answered, the others only where the scan has such a part.
const std::set<std::string> kAlways = {"nose_tip",       "nose_corner_left", "nose_corner_right",
                                       "eye_outer_left", "eye_inner_left",   "eye_inner_right",
                                       "eye_outer_right"};
constexpr double kThere = 0.3;  // [-] confidence

HeadFrame frame_of(const FacePose& pose) {
  HeadFrame frame;
  frame.rotation = pose.rotation.transpose();
  frame.origin = 0.5 * (pose.to_scan(face_model().mark("eye_outer_left", pose.shape)) +
                        pose.to_scan(face_model().mark("eye_outer_right", pose.shape)));
  return frame;
}

std::map<std::string, Vec3> marks_in(const HeadFrame& frame, const FacePose& pose) {
  std::map<std::string, Vec3> marks;
  for (const auto& [name, unused] : face_model().marks) {
    marks[name] = frame.to_head(pose.to_scan(face_model().mark(name, pose.shape)));
  }
  return marks;
}

void put_on_surface(const Skin& skin, const HeadFrame& frame, std::map<std::string, Vec3>& marks) {
  for (auto& [name, p] : marks) {
    if (name.starts_with("ear_")) continue;  // the middle of an auricle lies between its sheets
    p = frame.to_head(skin.query.closest(frame.to_scan(p)).point);
  }
}

// Corners of open eyes, from the scan itself.
Pins eye_corners(const Skin& skin, const SurfaceMesh& scan, const HeadFrame& frame,
                 const std::map<std::string, Vec3>& marks) {
  Pins pins;
  const surface::SurfaceQuery query(scan);
  for (const std::string side : {"_left", "_right"}) {
    const std::string name = "eye_outer" + side;
    const auto corner =
        open_eye_corner(query, skin.query, frame, marks.at("eye_inner" + side), marks.at(name));
    if (corner) pins[name] = frame.to_scan(*corner);
  }
  return pins;
}

LandmarkSet robust_landmarks(const Skin& skin, const FacePose& pose, const HeadFrame& frame,
                             const SurfaceMesh* scan) {
  auto marks = marks_in(frame, pose);
  put_on_surface(skin, frame, marks);
  const Relief relief = cast_relief(skin.query, frame, {-75, 75, -130, 70});
  marks["nose_tip"] = sharpen_nose_tip(relief, marks["nose_tip"]);
  const double tip = marks["nose_tip"].y();
  const Relief nose = cast_relief(skin.query, frame, {-35, 35, tip - 25, tip + 25}, 0.5);
  for (const char* name : {"nose_corner_left", "nose_corner_right"}) {
    marks[name] = sharpen_nose_corner(nose, marks[name]);
  }
  if (scan) {
    for (const auto& [name, p] : eye_corners(skin, *scan, frame, marks)) {
      marks[name] = frame.to_head(p);
    }
  }
  LandmarkSet set;
  for (const auto& [name, p] : marks) {
    const double sure = confidence(skin, pose, name);
    if (sure >= kThere || always_answered(name)) set[name] = {frame.to_scan(p), sure};
  }
  return set;
}

// The published recipe has no measure of its own; the robust method is its check.
void compare(const LandmarkSet& published, const LandmarkSet& robust,
             std::vector<std::string>& warnings) {
  constexpr double kFar = 8;  // [mm]
  for (const auto& [name, mark] : published) {
    const double apart = (mark.position - robust.at(name).position).norm();
    if (apart < kFar) continue;
    warnings.push_back(
        fmt::format("{}: the published recipe puts it {:.0f} mm from where the robust method does",
                    name, apart));
  }
}

}  // namespace

bool always_answered(const std::string& name) {
  return kAlways.contains(name);
}

static FoundFace find(const SurfaceMesh& mesh, const DetectOptions& options,
                      bool face_alone_will_do, const Progress& progress) {
  for (const auto& [name, p] : options.given) {
    if (!p.allFinite()) throw InputError(fmt::format("landmark {}: not a finite point", name));
  }
  progress.step("landmarks", 0);
  const Skin skin(mesh);
  const FaceSearch found = search_face(skin, options.given, progress);
  FoundFace result;
  Detection& detection = result.detection;
  result.alone = verify_face(skin, found, options.given, face_alone_will_do, detection.warnings);

  detection.frame = frame_of(found.pose);
  detection.mouth_opening = FaceModel::kOpeningAngle * found.pose.shape[FaceModel::kOpening];
  if (options.method == Method::published) {
    detection.landmarks = published_landmarks(skin, detection.frame);
    compare(detection.landmarks, robust_landmarks(skin, found.pose, detection.frame, options.scan),
            detection.warnings);
  } else {
    detection.landmarks = robust_landmarks(skin, found.pose, detection.frame, options.scan);
  }
  for (const auto& [name, p] : options.given) detection.landmarks[name] = {p, 1.0};
  detection.frame.origin = 0.5 * (detection.landmarks.at("eye_outer_left").position +
                                  detection.landmarks.at("eye_outer_right").position);
  progress.step("landmarks", 1);
  return result;
}

FoundFace find_face(const SurfaceMesh& skin, const DetectOptions& options,
                    const Progress& progress) {
  return find(skin, options, true, progress);
}

Detection detect_landmarks(const SurfaceMesh& skin, const DetectOptions& options,
                           const Progress& progress) {
  return find(skin, options, false, progress).detection;
}

}  // namespace palpate::landmarks
