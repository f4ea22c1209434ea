// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/face_model.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "landmarks/face_warp.hpp"

namespace palpate::landmarks {
namespace {

TEST(FaceModel, EveryShapeIsSymmetric) {
  const FaceModel& model = face_model();
  FaceModel::Coefficients c{};
  for (int k = 0; k < FaceModel::kModes; ++k) c[k] = 0.3 * (k % 5) - 0.6;
  for (const auto& [name, unused] : model.marks) {
    const auto left = name.rfind("_left");
    if (left == std::string::npos) continue;
    const Vec3 p = model.mark(name, c), q = model.mark(name.substr(0, left) + "_right", c);
    EXPECT_EQ(p, Vec3(-q.x(), q.y(), q.z())) << name;
  }
}

// Farkas 1994, adults, mean +- 3 SD of both sexes: the model must be a person.
TEST(FaceModel, MeanHasHumanMeasures) {
  const auto& m = face_model().marks;
  const auto apart = [&](const char* a, const char* b) { return (m.at(a) - m.at(b)).norm(); };
  EXPECT_NEAR(apart("eye_inner_left", "eye_inner_right"), 33, 9);
  EXPECT_NEAR(apart("eye_outer_left", "eye_outer_right"), 89, 12);
  EXPECT_NEAR(apart("nose_corner_left", "nose_corner_right"), 33, 9);
  EXPECT_NEAR(apart("nasion", "subnasale"), 52, 12);
  EXPECT_NEAR(apart("nasion", "gnathion"), 116, 22);
  EXPECT_NEAR(apart("mouth_corner_left", "mouth_corner_right"), 52, 12);
}

TEST(FaceModel, NormalsAreUnit) {
  for (const Vec3& n : face_model().normals) EXPECT_NEAR(n.norm(), 1, 1e-9);
}

LandmarkSet marks_as_landmarks(double scale) {
  LandmarkSet set;
  for (const auto& [name, p] : face_model().marks) set[name] = {scale * p, 1};
  return set;
}

TEST(FaceWarp, TheMeanFaceStaysWhereItIs) {
  const FaceWarp warp(marks_as_landmarks(1));
  for (const Vec3& p : face_model().points) EXPECT_LT((warp.to_mean(p) - p).norm(), 1e-9);
}

TEST(FaceWarp, SizeIsTakenOut) {
  const FaceWarp warp(marks_as_landmarks(0.8));
  for (const Vec3& p : face_model().points) EXPECT_LT((warp.to_mean(0.8 * p) - p).norm(), 1e-6);
}

TEST(FaceWarp, MissingAnchorIsNamed) {
  LandmarkSet set = marks_as_landmarks(1);
  set.erase("nose_tip");
  try {
    const FaceWarp warp(set);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nose_tip"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::landmarks
