// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/detect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "landmarks/pose.hpp"
#include "landmarks/sharpen.hpp"
#include "landmarks/verify.hpp"

namespace palpate::landmarks {
namespace {

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

}  // namespace

Detection detect_landmarks(const SurfaceMesh& mesh, const DetectOptions& options,
                           const Progress& progress) {
  for (const auto& [name, p] : options.given) {
    if (!p.allFinite()) throw InputError(fmt::format("landmark {}: not a finite point", name));
  }
  progress.step("landmarks", 0);
  const Skin skin(mesh);
  const FaceSearch found = search_face(skin, options.given, progress);
  Detection detection;
  verify_face(skin, found, detection.warnings);

  HeadFrame& frame = detection.frame;
  frame = frame_of(found.pose);
  auto marks = marks_in(frame, found.pose);
  const Relief relief = cast_relief(skin.query, frame, {-75, 75, -130, 70});
  put_on_surface(skin, frame, marks);
  marks["nose_tip"] = sharpen_nose_tip(relief, marks["nose_tip"]);
  for (const auto& [name, p] : options.given) marks[name] = frame.to_head(p);

  const Vec3 middle = 0.5 * (marks.at("eye_outer_left") + marks.at("eye_outer_right"));
  for (const auto& [name, p] : marks) {
    const bool given = options.given.contains(name);
    detection.landmarks[name] = {frame.to_scan(p), given ? 1.0 : confidence(skin, found.pose, name)};
  }
  frame.origin = frame.to_scan(middle);
  progress.step("landmarks", 1);
  return detection;
}

}  // namespace palpate::landmarks
