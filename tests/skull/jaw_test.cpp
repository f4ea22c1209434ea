// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/jaw.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "core/error.hpp"
#include "io/assets.hpp"
#include "io/scan.hpp"
#include "opening.hpp"
#include "skull/clip.hpp"
#include "skull/depth_fit.hpp"
#include "skull/fit.hpp"
#include "skull/skull_map.hpp"

namespace palpate::skull {
namespace {

const SkullTemplate& bundled_template() {
  static const SkullTemplate skull =
      io::read_skull_template(io::data_folder() / "skull_template.ply");
  return skull;
}

TEST(Jaw, TakesTheChinAndLeavesTheFaceAlone) {
  const SkullTemplate& skull = bundled_template();
  const Jaw jaw = find_jaw(skull);
  ASSERT_TRUE(jaw.present);
  for (const char* code : {"pg", "gn", "me", "sm", "id", "go_left", "mmb_left", "iM2_right"})
    EXPECT_EQ(jaw.weight(skull.landmarks.at(code).position), 1) << code;
  for (const char* code : {"n", "ss", "pr", "sM2_left", "zy_left", "im_left", "po_left", "op"})
    EXPECT_EQ(jaw.weight(skull.landmarks.at(code).position), 0) << code;
  for (std::size_t v = 0; v < skull.mesh.points.size(); ++v)
    if (skull.region[v] != SkullRegion::jaw && skull.region[v] != SkullRegion::chin &&
        skull.region[v] != SkullRegion::none) {
      EXPECT_LT(jaw.weight(skull.mesh.points[v]), 0.2);
    }
}

TEST(Jaw, NeedsARegionAndItsLandmarks) {
  SkullTemplate skull = bundled_template();
  skull.landmarks.erase("go_left");
  EXPECT_FALSE(find_jaw(skull).present);
  skull = bundled_template();
  for (SkullRegion& r : skull.region)
    if (r == SkullRegion::jaw || r == SkullRegion::chin) r = SkullRegion::none;
  const Jaw none = find_jaw(skull);
  EXPECT_FALSE(none.present);
  EXPECT_EQ(none.weight({0, -85, 80}), 0);
  const JawMotion still = move_jaw(none, {0.3, 5, 2}, {0, -85, 80}, 0);
  EXPECT_EQ(still.position, Vec3(0, -85, 80));
  EXPECT_EQ(still.by_pose, Mat3::Zero());
}

TEST(Jaw, DerivativesAreThoseOfTheMotion) {
  const Jaw jaw = find_jaw(bundled_template());
  const double h = 1e-5;
  for (const Vec3& x : {Vec3(10, -53, 85), Vec3(45, -33, 30), Vec3(-44, -45, 44), Vec3(0, -85, 80)})
    for (const JawPose& pose : {JawPose{0, 0, 0}, JawPose{0.2, -1, 2}, JawPose{0.4, 3, -1}}) {
      const double w = jaw.weight(x);
      const JawMotion m = move_jaw(jaw, pose, x, w);
      for (int a = 0; a < 3; ++a) {
        const Vec3 e = h * Vec3::Unit(a);
        EXPECT_NEAR(jaw.weight_gradient(x)[a], (jaw.weight(x + e) - jaw.weight(x - e)) / (2 * h),
                    1e-6);
        const Vec3 turned =
            (move_jaw(jaw, pose, x + e, w).position - move_jaw(jaw, pose, x - e, w).position) /
            (2 * h);
        EXPECT_LT((m.turn.col(a) - turned).norm(), 1e-7);
        const Vec3 posed = (move_jaw(jaw, JawPose::from(pose.vector() + e), x, w).position -
                            move_jaw(jaw, JawPose::from(pose.vector() - e), x, w).position) /
                           (2 * h);
        EXPECT_LT((m.by_pose.col(a) - posed).norm(), 1e-5);
      }
      const Vec3 weighed =
          (move_jaw(jaw, pose, x, w + h).position - move_jaw(jaw, pose, x, w - h).position) /
          (2 * h);
      EXPECT_LT((m.by_weight - weighed).norm(), 1e-5);
    }
}

TEST(Jaw, GradientOfTheWholeMapHoldsThePose) {
  const SkullTemplate& skull = bundled_template();
  SkullMap map{Mat3(Eigen::AngleAxisd(0.1, Vec3(1, 2, 3).normalized())) * 1.05,
               {3, 4, 5},
               SplineLattice(bounding_box(skull.mesh.points), 40),
               {},
               find_jaw(skull),
               {0.25, 2, 1}};
  map.control.resize(map.lattice.size(), 3);
  for (Eigen::Index i = 0; i < map.control.size(); ++i)
    map.control.data()[i] = 3 * std::sin(1.7 * static_cast<double>(i));
  const double h = 1e-5;
  for (const Vec3& x : {Vec3(10, -53, 85), Vec3(45, -33, 30), Vec3(0, 60, 80)})
    for (int a = 0; a < 3; ++a) {
      const Vec3 e = h * Vec3::Unit(a);
      EXPECT_LT((map.gradient(x).col(a) - (map(x + e) - map(x - e)) / (2 * h)).norm(), 1e-6);
    }
}

TEST(Jaw, OpensWithoutFoldingOrCuttingItself) {
  const SkullTemplate& skull = bundled_template();
  const Jaw jaw = find_jaw(skull);
  for (const JawPose& pose : {JawPose{12 * kDegree, 0, 0}, JawPose{kWidestOpening, 0, 0},
                              JawPose{0, 5, 0}, JawPose{20 * kDegree, -4, 3}}) {
    SurfaceMesh opened = skull.mesh;
    for (Vec3& p : opened.points) {
      const JawMotion m = move_jaw(jaw, pose, p, jaw.weight(p));
      EXPECT_GT((m.turn + m.by_weight * jaw.weight_gradient(p).transpose()).determinant(), 0.5);
      p = m.position;
    }
    EXPECT_EQ(count_self_intersections(opened), 0u);
  }
}

TEST(Jaw, MirroredPlaceAndPoseGiveMirroredMotion) {
  const Jaw jaw = find_jaw(bundled_template());
  const auto mirrored = [](Vec3 p) { return Vec3(-p.x(), p.y(), p.z()); };
  for (const Vec3& x : {Vec3(10, -53, 85), Vec3(45, -33, 30)}) {
    EXPECT_EQ(jaw.weight(x), jaw.weight(mirrored(x)));
    const Vec3 a = move_jaw(jaw, {0.2, 1, 2}, x, jaw.weight(x)).position;
    const Vec3 b = move_jaw(jaw, {0.2, 1, -2}, mirrored(x), jaw.weight(x)).position;
    EXPECT_LT((a - mirrored(b)).norm(), 1e-12);
  }
}

bool is_closed(const SurfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> sides;  // of every edge, one way less the other
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return std::all_of(sides.begin(), sides.end(), [](const auto& s) { return s.second == 0; });
}

/// Whether bone lies at `p`: the winding number by the solid angles of the triangles (van Oosterom
/// & Strackee 1983).
bool in_bone(const SurfaceMesh& mesh, const Vec3& p) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]] - p, b = mesh.points[t[1]] - p, c = mesh.points[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum > 2 * std::numbers::pi;
}

TEST(PartedTeeth, LeaveNoBoneBetweenThemWhenTheMouthOpens) {
  const SkullTemplate& skull = bundled_template();
  const PartedTeeth parted = part_teeth(skull, find_jaw(skull));
  ASSERT_EQ(parted.skull.region.size(), parted.skull.mesh.points.size());
  EXPECT_TRUE(is_closed(parted.skull.mesh));
  EXPECT_EQ(part_teeth(skull, find_jaw(skull)).skull.mesh.points, parted.skull.mesh.points);
  const auto opened = [&](const SkullTemplate& s, const Jaw& jaw) {
    SurfaceMesh mesh = s.mesh;
    for (Vec3& p : mesh.points) p = move_jaw(jaw, {20 * kDegree, 0, 0}, p, jaw.weight(p)).position;
    return mesh;
  };
  const SurfaceMesh with = opened(skull, find_jaw(skull)),
                    without = opened(parted.skull, parted.jaw);
  EXPECT_EQ(count_self_intersections(without), 0u);
  const Jaw& jaw = parted.jaw;
  const Vec3 upper = skull.landmarks.at("pr").position;
  const Vec3 lower =
      move_jaw(jaw, {20 * kDegree, 0, 0}, skull.landmarks.at("id").position, 1).position;
  const Vec3 between = 0.5 * (upper + lower) - Vec3(0, 0, 8);  // well inside the row of teeth
  EXPECT_TRUE(in_bone(with, between));
  EXPECT_FALSE(in_bone(without, between));
  for (const auto& [code, landmark] : skull.landmarks)
    EXPECT_NEAR(jaw.weight(landmark.position), find_jaw(skull).weight(landmark.position), 1e-12)
        << code;
}

TEST(PartedTeeth, AnOpenTemplateIsSaidSo) {
  SkullTemplate skull = bundled_template();
  skull.mesh.triangles.pop_back();
  EXPECT_THROW(static_cast<void>(part_teeth(skull, find_jaw(skull))), SolveError);
}

/// The bundled head, closed, with the landmarks that its model has and those that can be seen.
HeadSurface bundled_head() {
  HeadSurface head;
  head.skin = io::read_scan(io::data_folder() / "head.ply").mesh;
  head.filled.assign(head.skin.points.size(), 0);
  for (const Vec3& p : head.skin.points) {
    const bool neck = p.y() < (p.z() < 10 ? -60 : -84 - 0.5 * (p.z() - 14));
    head.region.push_back(neck ? SkinRegion::neck : SkinRegion::other);
  }
  const auto put = [&](const std::string& name, const Vec3& p) { head.landmarks[name] = {p, 1}; };
  put("nose_tip", {0, -20.974, 105.732});
  put("chin", {0, -80.0, 87.2});
  for (const double side : {1.0, -1.0}) {
    const std::string end = side > 0 ? "_left" : "_right";
    put("nose_corner" + end, {side * 16.966, -21.61, 89.026});
    put("eye_outer" + end, {side * 43.419, 15.571, 73.582});
    put("ear" + end, {side * 77.3, 1.4, -11.7});
  }
  return head;
}

/// Coarser than the default: here poses are looked at, not tenths of a millimetre.
FitOptions quick() {
  FitOptions options;
  options.depth.spacing = 60;
  options.depth.sampling = 8;
  return options;
}

SkullFit fit_quickly(const HeadSurface& head, const SkullTemplate& skull,
                     const FitOptions& options = quick()) {
  return fit_skull(head, skull, io::read_tissue_depths(io::data_folder() / "tissue_depth.csv"),
                   options);
}

const SkullFit& closed_fit() {
  static const SkullFit fit = fit_quickly(bundled_head(), bundled_template());
  return fit;
}

struct Opened {
  HeadSurface head;
  std::vector<Vec3> jaw;  ///< where each point of the closed fit lies if all of it were jaw
};
Opened opened_by(double degrees) {
  const SkullFit& closed = closed_fit();
  const Vec3 joint =
      0.5 * (closed.landmarks.at("po_left").position + closed.landmarks.at("po_right").position) +
      Vec3(0, -4, 14);
  const Opening opening{joint, degrees * kDegree};
  Opened opened{bundled_head(), {}};
  for (Vec3& p : opened.head.skin.points) p = opening(p);
  for (auto& [name, landmark] : opened.head.landmarks)
    landmark.position = opening(landmark.position);
  for (const Vec3& p : closed.mesh.points) opened.jaw.push_back(opening.rigid(p));
  return opened;
}

/// [mm] mean distance of the body of the jaw from where it should be.
double jaw_error(const SkullFit& fit, const Opened& truth, const SkullTemplate& skull) {
  // An open mouth's template has parted teeth; away from them its points are the template's own.
  const SurfaceMesh parted = part_teeth(skull, find_jaw(skull)).skull.mesh;
  EXPECT_EQ(fit.mesh.points.size(), parted.points.size());  // nothing was cut off
  std::map<std::array<double, 3>, std::size_t> number;
  for (std::size_t v = 0; v < parted.points.size(); ++v)
    number[{parted.points[v].x(), parted.points[v].y(), parted.points[v].z()}] = v;
  const SkullTemplate& bundled = bundled_template();
  double sum = 0;
  int count = 0;
  for (std::size_t v = 0; v < bundled.mesh.points.size(); ++v) {
    if (bundled.region[v] != SkullRegion::jaw && bundled.region[v] != SkullRegion::chin) continue;
    if (bundled.mesh.points[v].y() > -62) continue;
    const Vec3& p = skull.mesh.points[v];
    const auto same = number.find({p.x(), p.y(), p.z()});
    if (same == number.end()) continue;
    sum += (fit.mesh.points[same->second] - truth.jaw[v]).norm();
    ++count;
  }
  EXPECT_GT(count, 500);
  return sum / count;
}

double depth_at(const SkullFit& fit, const std::string& code) {
  for (const DepthRow& row : fit.depths)
    if (row.code == code && row.reached) return row.depth_mm;
  return std::numeric_limits<double>::quiet_NaN();
}

void expect_sound(const SkullFit& fit) {
  EXPECT_EQ(fit.statistics.at("self_intersections"), 0);
  EXPECT_EQ(fit.statistics.at("outside_count"), 0);
  EXPECT_GE(fit.statistics.at("min_clearance_mm"), 2.5);
  EXPECT_GT(fit.statistics.at("least_jacobian"), 0.3);
}

TEST(JawFit, ClosedHeadStaysClosed) {
  EXPECT_LT(closed_fit().statistics.at("jaw_opening_deg"), 1.5);
  EXPECT_LT(std::abs(closed_fit().statistics.at("jaw_shift_mm")), 0.5);
  expect_sound(closed_fit());
}

TEST(JawFit, OpenMouthIsAPoseNotAShape) {
  const Opened truth = opened_by(20);
  const SkullFit fit = fit_quickly(truth.head, bundled_template());
  const auto& s = fit.statistics;
  // How steep a person's jaw is in closed bite, nobody knows: the stated doubt holds that.
  EXPECT_LT(std::abs(s.at("jaw_opening_deg") - 20), 2 * s.at("jaw_opening_sd_deg"));
  EXPECT_LT(s.at("jaw_opening_sd_deg"), 4);
  EXPECT_LT(std::abs(s.at("jaw_shift_mm")), 0.5);
  expect_sound(fit);
  for (const char* code : {"gn", "me", "mmb_left", "mmb_right"})
    EXPECT_NEAR(depth_at(fit, code), depth_at(closed_fit(), code), 2.5) << code;
  FitOptions options = quick();
  options.depth.jaw_pose = false;
  const SkullFit shape = fit_quickly(truth.head, bundled_template(), options);
  EXPECT_FALSE(shape.statistics.contains("jaw_opening_deg"));
  EXPECT_LT(jaw_error(fit, truth, bundled_template()), 4);
}

/// The bundled head's own skull as a template: only the pose is unknown.
TEST(JawFit, PoseOfAKnownShapeIsRecovered) {
  SkullTemplate own = bundled_template();
  own.mesh = closed_fit().mesh;
  own.landmarks = closed_fit().landmarks;
  for (auto& [name, p] : own.registration_points) p = bundled_head().landmarks.at(name).position;
  const Opened truth = opened_by(12);
  const SkullFit fit = fit_quickly(truth.head, own);
  EXPECT_NEAR(fit.statistics.at("jaw_opening_deg"), 12, 2);
  EXPECT_LT(jaw_error(fit, truth, own), 2.5);
  expect_sound(fit);
}

TEST(JawFit, SameBitsTwice) {
  FitOptions options;
  options.depth.spacing = 80;
  options.depth.sampling = 20;
  const Opened opened = opened_by(15);
  const SkinField skin(opened.head);
  const DepthModel model = make_depth_model(
      bundled_template(), io::read_tissue_depths(io::data_folder() / "tissue_depth.csv"));
  const auto points = make_fit_points(opened.head, bundled_template(), model, options);
  const auto start = registration::place_similarity(opened.head, bundled_template());
  const auto solved = [&] {
    return solve_depth_fit(bundled_template(), points, skin, start, 0, options, {});
  };
  const DepthFit a = solved(), b = solved();
  EXPECT_GT(a.map.pose.opening, 8 * kDegree);
  EXPECT_EQ(a.map.control, b.map.control);
  EXPECT_EQ(a.map.pose.vector(), b.map.pose.vector());
  EXPECT_EQ(a.information, b.information);
}

}  // namespace
}  // namespace palpate::skull
