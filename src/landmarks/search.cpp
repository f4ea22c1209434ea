// SPDX-License-Identifier: GPL-3.0-or-later
// Every dome of the surface may be the nose tip. A dome points away from the middle of its
// surroundings, as the nose does in the model; the roll about that direction is tried in steps. The
// statistical face is laid on the surface for each hypothesis, roughly for all, better for the
// best.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/error.hpp"
#include "landmarks/pose.hpp"

namespace palpate::landmarks {
namespace {

constexpr int kDomes = 24;           // hypotheses for the tip
constexpr int kRolls = 24;           // 15 degrees apart; the fit converges from within about 20
constexpr double kAround = 40;       // [mm] surroundings of a dome
constexpr double kDomeApart = 10;    // [mm] domes closer than this are one
constexpr double kFlattest = -0.02;  // [1/mm] the flatter curvature of a dome: radius 50 mm at most

// Stride, shape and tolerance [mm] sharpen while the hypotheses thin out.
constexpr FitSchedule kRough = {
    .iterations = 4, .stride = 5, .with_scale = false, .tolerance_mm = 6};
constexpr FitSchedule kBetter = {.iterations = 6, .stride = 3, .tolerance_mm = 5};
constexpr FitSchedule kShaped = {.iterations = 10, .with_shape = true, .tolerance_mm = 4};
constexpr FitSchedule kFinal = {.iterations = 15, .with_shape = true, .tolerance_mm = 2.5};

struct Hypothesis {
  FacePose pose;
  double cost = 0;
};

// Where the nose points in the head frame, by the same measure on the model's mean head.
const Vec3 kNoseDirection = Vec3(0, 0.06, 1).normalized();

Vec3 pointing(const Skin& skin, const Vec3& tip) {
  std::vector<surface::PointTree::Neighbour> found;
  skin.tree.within(tip, kAround, found);
  Vec3 middle = Vec3::Zero();
  for (const auto& f : found) middle += skin.mesh.points[f.point];
  const Vec3 d = tip - middle / static_cast<double>(found.size());
  return d.norm() > 1e-9 ? Vec3(d.normalized()) : Vec3(Vec3::UnitZ());
}

FacePose start_pose(const Vec3& tip, const Vec3& direction, double roll) {
  const Mat3 align =
      Eigen::Quaterniond::FromTwoVectors(kNoseDirection, direction).toRotationMatrix();
  FacePose pose;
  pose.rotation = Eigen::AngleAxisd(roll, direction).toRotationMatrix() * align;
  pose.translation = tip - pose.rotation * face_model().marks.at("nose_tip");
  return pose;
}

void keep_best(std::vector<Hypothesis>& all, std::size_t n) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  if (all.size() > n) all.resize(n);
}

bool same_place(const FacePose& a, const FacePose& b) {
  const double angle = Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
  const Vec3 tip = face_model().marks.at("nose_tip");
  return angle < 20 * std::numbers::pi / 180 && (a.to_scan(tip) - b.to_scan(tip)).norm() < 20;
}

struct Selection {
  std::size_t keep;  // hypotheses
  int stride;        // through the model's points when judging
};

void refine(const Skin& skin, std::vector<Hypothesis>& all, const FitSchedule& schedule,
            const Pins& pins, const Selection& selection, const Progress& progress) {
  constexpr std::size_t kAtOnce = 32;  // hypotheses between two looks at whether to go on
  for (std::size_t first = 0; first < all.size(); first += kAtOnce) {
    progress.step("landmarks", 0);
    tbb::parallel_for(first, std::min(all.size(), first + kAtOnce), [&](std::size_t i) {
      all[i].pose = fit_pose(skin, all[i].pose, schedule, pins);
      all[i].cost = judge(skin, all[i].pose, selection.stride).cost();
    });
  }
  keep_best(all, selection.keep);
}

void drop_repeats(std::vector<Hypothesis>& all) {
  std::vector<Hypothesis> kept;
  for (const Hypothesis& h : all) {
    const bool repeat = std::any_of(
        kept.begin(), kept.end(), [&](const Hypothesis& k) { return same_place(k.pose, h.pose); });
    if (!repeat) kept.push_back(h);
  }
  all = std::move(kept);
}

}  // namespace

std::vector<int> dome_points(const Skin& skin, int at_most) {
  std::vector<int> order;
  for (std::size_t i = 0; i < skin.mesh.points.size(); ++i) {
    if (skin.curvature[i].k_max < kFlattest) order.push_back(static_cast<int>(i));
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return skin.curvature[a].k_max < skin.curvature[b].k_max; });
  std::vector<int> domes;
  for (int i : order) {
    const bool apart = std::all_of(domes.begin(), domes.end(), [&](int j) {
      return (skin.mesh.points[i] - skin.mesh.points[j]).norm() > kDomeApart;
    });
    if (apart) domes.push_back(i);
    if (static_cast<int>(domes.size()) == at_most) break;
  }
  return domes;
}

namespace {

std::vector<Hypothesis> hypotheses(const Skin& skin, const Pins& pins) {
  std::vector<Vec3> tips;
  const auto given = pins.find("nose_tip");
  if (given != pins.end()) {
    tips.push_back(given->second);
  } else {
    for (int i : dome_points(skin, kDomes)) tips.push_back(skin.mesh.points[i]);
  }
  std::vector<Hypothesis> all;
  for (const Vec3& tip : tips) {
    const Vec3 direction = pointing(skin, tip);
    for (int k = 0; k < kRolls; ++k) {
      all.push_back({start_pose(tip, direction, 2 * std::numbers::pi * k / kRolls), 0});
    }
  }
  return all;
}

// What moves when the mouth opens says nothing of where the head is.
Pins without_the_jaw(Pins pins) {
  for (const char* name :
       {"chin", "gnathion", "stomion", "mouth_corner_left", "mouth_corner_right"})
    pins.erase(name);
  return pins;
}

// The same face with its mouth open, where that explains the lower face better: on heads whose
// mouth is shut the best open one costs as much or more, and where it is open by 12 degrees and
// more 1.1 to 3.7 mm less.
void open_mouth(const Skin& skin, const FacePose& start, const Pins& pins, FaceSearch& face) {
  constexpr double kStarts[] = {0.4, 0.8, 1.2};  // [-] way of the opening: 8 to 23 degrees
  constexpr double kGain = 0.5;                  // [mm] of the lower face's cost
  constexpr double kLeast = 0.15;                // [-] 3 degrees
  FitSchedule shaped = kShaped, final = kFinal;
  shaped.with_mouth = final.with_mouth = true;
  const auto cost = [](const FaceFit& fit) { return fit.core.cost() + fit.lower.cost(); };
  std::array<FacePose, std::size(kStarts)> poses;
  std::array<FaceFit, std::size(kStarts)> fits;
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    FacePose pose = start;
    pose.shape = {};
    pose.shape[FaceModel::kOpening] = kStarts[i];
    poses[i] = fit_pose(skin, fit_pose(skin, pose, shaped, pins), final, pins);
    fits[i] = judge(skin, poses[i]);
  });
  std::size_t best = 0;
  for (std::size_t i = 1; i < fits.size(); ++i)
    if (cost(fits[i]) < cost(fits[best])) best = i;
  const double opening = poses[best].shape[FaceModel::kOpening];
  if (opening < kLeast || cost(fits[best]) > cost(face.fit) - kGain) return;
  face.pose = poses[best];
  face.fit = fits[best];
}

}  // namespace

FaceSearch search_face(const Skin& skin, const Pins& pins, const Progress& progress) {
  std::vector<Hypothesis> all = hypotheses(skin, pins);
  if (all.empty()) {
    throw InputError(
        "no face found: looked for a nose tip (a dome that bends with a radius of 50 mm or less) "
        "and found no dome at all");
  }
  const Pins still = without_the_jaw(pins);
  refine(skin, all, kRough, still, {48, 5}, progress);
  refine(skin, all, kBetter, still, {16, 2}, progress);
  drop_repeats(all);
  refine(skin, all, kShaped, still, {16, 1}, progress);
  drop_repeats(all);
  FaceSearch result;
  result.pose = fit_pose(skin, all[0].pose, kFinal, pins);
  result.fit = judge(skin, result.pose);
  open_mouth(skin, all[0].pose, pins, result);
  if (all.size() > 1) result.rival = judge(skin, all[1].pose);
  return result;
}

}  // namespace palpate::landmarks
