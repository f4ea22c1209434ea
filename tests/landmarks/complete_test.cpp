// SPDX-License-Identifier: GPL-3.0-or-later
// The bundled head, cut before the ears and stretched, so that it is no longer the one that
// completes it, mirrored and turned: what lies behind is known. One completion serves all tests.
#include "landmarks/complete.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "core/error.hpp"
#include "heads.hpp"
#include "surface/intersections.hpp"
#include "surface/query.hpp"

namespace palpate::landmarks {
namespace {

const Mat3 kTurn = Eigen::AngleAxisd(2.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
const Mat3 kMirroredStretch = Vec3(-1.06, 0.96, 1.04).asDiagonal();
const Vec3 kShift(300, -40, 1000);

/// Of the bundled head to the scan.
SurfaceMesh placed(const SurfaceMesh& mesh) {
  SurfaceMesh out = transformed(mesh, kTurn * kMirroredStretch, kShift);
  for (Triangle& t : out.triangles) std::swap(t[1], t[2]);
  return out;
}
/// Where a point of the scan lies; its left is the bundled head's right.
Vec3 truth_of(const std::string& name) {
  std::string there = name;
  if (const auto left = there.rfind("_left"); left != std::string::npos)
    there.replace(left, 5, "_right");
  else if (const auto right = there.rfind("_right"); right != std::string::npos)
    there.replace(right, 6, "_left");
  return kTurn * (kMirroredStretch * bundled_head().truth.at(there)) + kShift;
}

/// From the hairline to below the chin, askew behind.
SurfaceMesh face_of(const KnownHead& head) {
  SurfaceMesh face{head.scan.points, {}};
  const Vec3 eye = head.truth.at("eye_outer_left"), tip = head.truth.at("nose_tip");
  for (const Triangle& t : head.scan.triangles) {
    const Vec3& p = face.points[t[0]];
    if (p.z() + 0.1 * p.x() > eye.z() - 48 && p.y() < eye.y() + 75 && p.y() > tip.y() - 85)
      face.triangles.push_back(t);
  }
  return face;
}

struct Completed {
  SurfaceMesh scan;
  surface::WorkingSurface working;
  CompletedFace head;
  Detection found;
};
Completed completed(const SurfaceMesh& scan) {
  Completed c{scan, surface::make_working_surface(scan), {}, {}};
  const FoundFace face = find_face(c.working.mesh, with_scan(c.scan));
  EXPECT_TRUE(face.alone);
  c.head = complete_face(c.working.mesh, c.working.filled, face.detection, bundled_head().scan, 3);
  c.found = detect_landmarks(c.head.skin, with_scan(c.scan));
  drop_unseen(c.found.landmarks, c.head);
  return c;
}
const Completed& stretched() {
  static const Completed c = completed(placed(face_of(bundled_head())));
  return c;
}

constexpr std::array<const char*, 5> kMeasured = {"nose_tip", "eye_outer_left", "eye_outer_right",
                                                  "eye_inner_left", "eye_inner_right"};

// The whole stretched head has 2.0 mm in the mean.
TEST(FaceAlone, PointsLieWhereTheWholeHeadHasThem) {
  double sum = 0;
  for (const char* name : kMeasured) {
    const double error = (stretched().found.landmarks.at(name).position - truth_of(name)).norm();
    EXPECT_LE(error, 5) << name;
    sum += error;
  }
  EXPECT_LE(sum / kMeasured.size(), 3);
  EXPECT_LT(Eigen::AngleAxisd(Mat3(stretched().found.frame.rotation * kTurn)).angle(),
            8 * std::numbers::pi / 180);
}

TEST(FaceAlone, WhatNobodyHasSeenIsNoLandmark) {
  EXPECT_FALSE(stretched().found.landmarks.contains("ear_left"));
  EXPECT_FALSE(stretched().found.landmarks.contains("ear_right"));
  EXPECT_TRUE(stretched().found.landmarks.contains("chin"));
}

TEST(FaceAlone, SkinIsOneClosedSurfaceThatKeepsTheScan) {
  const SurfaceMesh& skin = stretched().head.skin;
  EXPECT_TRUE(surface::self_intersections(skin).empty());
  EXPECT_EQ(skin.triangles.size(), 2 * skin.points.size() - 4);  // closed, without handles
  EXPECT_GT(signed_volume(skin), 0);
  const surface::SurfaceQuery query(skin);
  const surface::WorkingSurface& working = stretched().working;
  std::vector<double> off;
  for (std::size_t v = 0; v < working.filled.size(); ++v)
    if (!working.filled[v]) off.push_back(query.closest(working.mesh.points[v]).distance);
  std::sort(off.begin(), off.end());
  EXPECT_LT(off[off.size() * 95 / 100], 0.3);  // [mm]; measured: 0.11
}

TEST(FaceAlone, MarksTellScanFromCompletion) {
  const CompletedFace& head = stretched().head;
  SurfaceMesh scan = stretched().scan;  // its triangles alone
  const surface::SurfaceQuery query(scan);
  int wrong = 0, marked = 0;
  for (std::size_t v = 0; v < head.filled.size(); ++v) {
    const double off = query.closest(head.skin.points[v]).distance;
    wrong += head.filled[v] == 0 && off > 1.5;  // claimed as scanned, half an edge off
    wrong += head.filled[v] != 2 && off > 12;   // not even a closed hole
    marked += head.filled[v] == 2;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(marked, 0);
  EXPECT_GT(head.completed_share, 0.5);
  EXPECT_LT(head.completed_share, 0.8);
}

// No speck between the lids counts as another head's.
TEST(FaceAlone, CompletedSkinIsOnePiece) {
  const CompletedFace& head = stretched().head;
  std::vector<std::uint8_t> reached(head.filled.size(), 0);
  for (bool grew = true, first = true; grew; first = false) {
    grew = false;
    for (const Triangle& t : head.skin.triangles) {
      int completed = 0, there = 0;
      for (const std::int32_t v : t) completed += head.filled[v] == 2, there += reached[v];
      if (completed == 0 || there == 3 || (there == 0 && !first)) continue;
      for (const std::int32_t v : t) reached[v] = 1;
      grew = true;
      first = false;
    }
  }
  for (std::size_t v = 0; v < reached.size(); ++v)
    if (head.filled[v] == 2) ASSERT_TRUE(reached[v]) << v;
}

// Measured: 2.6 mm in the mean. It says what a face tells of its head where the heads are alike.
TEST(FaceAlone, BackIsNearTheTrueOne) {
  const surface::SurfaceQuery truth(placed(bundled_head().skin));
  const CompletedFace& head = stretched().head;
  double sum = 0, n = 0;
  for (std::size_t v = 0; v < head.filled.size(); ++v) {
    const double up = (kTurn.transpose() * (head.skin.points[v] - kShift)).y();
    if (head.filled[v] != 2 || up < -80) continue;  // the neck ends anywhere
    sum += truth.closest(head.skin.points[v]).distance;
    ++n;
  }
  RecordProperty("mean_mm", std::to_string(sum / n));
  EXPECT_LT(sum / n, 4);
}

}  // namespace
}  // namespace palpate::landmarks
