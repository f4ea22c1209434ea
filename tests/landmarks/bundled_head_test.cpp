// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numbers>

#include "../skull/opening.hpp"
#include "core/error.hpp"
#include "heads.hpp"

namespace palpate::landmarks {
namespace {

constexpr double kWorst = 4;  // [mm]

TEST(BundledHead, PointsLieWhereTheModelHasThem) {
  const KnownHead& head = bundled_head();
  const Detection found = detect_landmarks(head.skin, with_scan(head.scan));
  for (const auto& [name, p] : head.truth) {
    ASSERT_TRUE(found.landmarks.contains(name)) << name;
    EXPECT_LT((found.landmarks.at(name).position - p).norm(), kWorst) << name;
  }
  EXPECT_LT((found.landmarks.at("nose_tip").position - head.truth.at("nose_tip")).norm(), 3);
  for (const auto& [name, mark] : found.landmarks) {
    EXPECT_GE(mark.confidence, 0) << name;
    EXPECT_LE(mark.confidence, 1) << name;
  }
}

TEST(BundledHead, FrameIsUprightAndCentredBetweenTheEyes) {
  const KnownHead& head = bundled_head();
  const Detection found = detect_landmarks(head.skin);
  EXPECT_NEAR(found.frame.rotation.determinant(), 1, 1e-9);
  EXPECT_LT(Eigen::AngleAxisd(found.frame.rotation).angle(), 8 * kDegree);
  const Vec3 left = found.frame.to_head(found.landmarks.at("eye_outer_left").position);
  const Vec3 right = found.frame.to_head(found.landmarks.at("eye_outer_right").position);
  EXPECT_LT((left + right).norm(), 1e-9);
  EXPECT_GT(left.x(), 35);
}

// A turned head has turned landmarks: signed-axis frames with 15 degrees on top, and any pose.
TEST(BundledHead, AnyPoseGivesTheSamePoints) {
  const KnownHead& head = bundled_head();
  const Vec3 z = Vec3::UnitZ(), x = Vec3::UnitX();
  const std::vector<Mat3> turns = {
      Mat3(Eigen::AngleAxisd(90 * kDegree, x) * Eigen::AngleAxisd(15 * kDegree, z)),
      Mat3(Eigen::AngleAxisd(180 * kDegree, z) * Eigen::AngleAxisd(-15 * kDegree, x)),
      Mat3(Eigen::AngleAxisd(137 * kDegree, Vec3(1, 2, -1).normalized())),
  };
  for (const Mat3& turn : turns) {
    const Vec3 shift(300, -40, 1000);
    const Detection found = detect_landmarks(transformed(head.skin, turn, shift));
    EXPECT_LT(largest_error(found, head.truth, turn, shift), kWorst);
  }
}

// The chin goes along, and nothing else: how far it went is the jaw's opening. This skin has no
// slit between its lips: opened further than 20 degrees it is like no face, and the chin must be
// given.
TEST(BundledHead, OpenMouthTakesTheChinAlong) {
  const KnownHead& head = bundled_head();
  const Detection shut = detect_landmarks(head.skin);
  EXPECT_EQ(shut.mouth_opening, 0);
  for (const double degrees : {15.0, 20.0, 28.0}) {
    const Opening opening{Vec3(0, -4, 14), degrees * kDegree};
    SurfaceMesh opened = head.skin;
    for (Vec3& p : opened.points) p = opening(p);
    const Vec3 chin = opening(shut.landmarks.at("chin").position);
    EXPECT_GT((chin - shut.landmarks.at("chin").position).norm(), degrees);
    DetectOptions options;
    options.given["chin"] = chin;
    EXPECT_NEAR(detect_landmarks(opened, options).mouth_opening, degrees * kDegree, 6 * kDegree);
    const Detection found = detect_landmarks(opened);
    EXPECT_LT(largest_error(found, head.truth, Mat3::Identity(), Vec3::Zero()), kWorst) << degrees;
    if (degrees > 20) {
      EXPECT_FALSE(found.warnings.empty());
      continue;
    }
    EXPECT_NEAR(found.mouth_opening, degrees * kDegree, 6 * kDegree);
    ASSERT_TRUE(found.landmarks.contains("chin")) << degrees;
    EXPECT_LT((found.landmarks.at("chin").position - chin).norm(), 6) << degrees;
  }
}

TEST(BundledHead, MirroredHeadGivesMirroredPoints) {
  const KnownHead& head = bundled_head();
  const Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  SurfaceMesh mirrored = transformed(head.skin, mirror, Vec3::Zero());
  for (Triangle& t : mirrored.triangles) std::swap(t[1], t[2]);
  const Detection plain = detect_landmarks(head.skin), turned = detect_landmarks(mirrored);
  for (const auto& [name, mark] : plain.landmarks) {
    std::string other = name;
    if (name.ends_with("_left")) other.replace(name.size() - 5, 5, "_right");
    if (name.ends_with("_right")) other.replace(name.size() - 6, 6, "_left");
    const Vec3 there = turned.landmarks.at(other).position;
    EXPECT_LT((mirror * mark.position - there).norm(), 1.0) << name;
  }
}

TEST(BundledHead, GivenPointsWinAndPullTheOthers) {
  const KnownHead& head = bundled_head();
  DetectOptions options;
  options.given["nose_tip"] = head.truth.at("nose_tip") + Vec3(0, 2, 0);
  const Detection found = detect_landmarks(head.skin, options);
  EXPECT_EQ(found.landmarks.at("nose_tip").position, options.given["nose_tip"]);
  EXPECT_EQ(found.landmarks.at("nose_tip").confidence, 1);
  options.given["nose_tip"].x() = std::nan("");
  EXPECT_THROW((void)detect_landmarks(head.skin, options), InputError);
}

TEST(BundledHead, SameBitsEachTime) {
  const KnownHead& head = bundled_head();
  const Detection a = detect_landmarks(head.skin), b = detect_landmarks(head.skin);
  for (const auto& [name, mark] : a.landmarks) {
    EXPECT_EQ(mark.position, b.landmarks.at(name).position) << name;
  }
}

}  // namespace
}  // namespace palpate::landmarks
