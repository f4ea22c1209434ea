// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace palpate::landmarks {
namespace {

constexpr double kWorstOutliers = 0.15;  // [-] share of outliers among eyes, brows and nose
constexpr double kWorstCore = 2.5;   // [mm] heads cost up to 2.0 there, other bumps 2.9 and more
constexpr double kWorstCost = 5.0;   // [mm] of the whole; heads up to 3.9, wrong places from 5.2
constexpr double kWorstLower = 1.9;  // [mm] shut mouths cost up to 1.3, most open ones up to 1.8
constexpr double kShortest = 65;     // [mm] behind the eyes, of a mean head; a mask ends at 50
constexpr double kWhole = 115;       // [mm] the same of a whole head: adults have 140

// Median distance from behind the nose's root to the skin at the back, for a mean-sized head [mm].
double depth_of_head(const Skin& skin, const FacePose& pose) {
  std::vector<double> hits;
  for (int yaw = -40; yaw <= 40; yaw += 10) {
    for (int pitch = -10; pitch <= 50; pitch += 10) {
      const double a = yaw * std::numbers::pi / 180, b = pitch * std::numbers::pi / 180;
      const Vec3 d(std::sin(a) * std::cos(b), std::sin(b), -std::cos(a) * std::cos(b));
      const auto hit = skin.query.cast(pose.to_scan(Vec3(0, 0, 0)), pose.rotation * d);
      hits.push_back(hit ? hit->distance / pose.scale : 0);
    }
  }
  std::nth_element(hits.begin(), hits.begin() + hits.size() / 2, hits.end());
  return hits[hits.size() / 2];
}

}  // namespace

bool verify_face(const Skin& skin, const FaceSearch& found, const Pins& given,
                 bool face_alone_will_do, std::vector<std::string>& warnings) {
  const FaceFit& fit = found.fit;
  if (fit.core.outliers > kWorstOutliers || fit.core.cost() > kWorstCore ||
      fit.cost() > kWorstCost) {
    throw InputError(fmt::format(
        "no face found: looked for a nose between two eyes under a brow in every pose; the best "
        "match is {:.1f} mm off with {:.0f} % of its points elsewhere; if it is a head, {}",
        fit.core.mean_distance, 100 * fit.core.outliers,
        given.empty() ? "name its nose tip" : "check the points that were given"));
  }
  const double depth = depth_of_head(skin, found.pose);
  const bool face_alone = depth < kShortest;
  if (face_alone && !(face_alone_will_do && fit.has_lower_face())) {
    throw InputError(fmt::format(
        "a face without the back of its head: the surface ends {:.0f} mm behind the eyes, a head "
        "reaches about 150 mm; scan the whole head",
        depth * found.pose.scale));
  }
  if (depth < kWhole && !face_alone) {
    warnings.push_back(fmt::format(
        "the back of the head is missing: the surface ends {:.0f} mm behind the eyes; there is no "
        "bone where there is no scan",
        depth * found.pose.scale));
  }
  if (!fit.has_lower_face()) {
    warnings.push_back("the scan ends above the chin: points that it does not show are left out");
  } else if (fit.lower.cost() > kWorstLower) {
    warnings.push_back(
        fmt::format("mouth and chin are {:.1f} mm off every face that is known (a beard, a hand, a "
                    "mouth wide open?); check the chin",
                    fit.lower.mean_distance));
  }
  if (found.rival.cost() < fit.cost() + 1) {
    warnings.push_back("a second place looks almost as much like a face; check the landmarks");
  }
  return face_alone;
}

double confidence(const Skin& skin, const FacePose& pose, const std::string& name) {
  constexpr double kNear = 15, kWorst = 6;  // [mm]
  const FaceModel& model = face_model();
  if (!model.marks.contains(name)) return 1;
  const Vec3 mark = model.marks.at(name);
  double sum = 0;
  int n = 0;
  std::vector<surface::PointTree::Neighbour> found;
  double reach = kNear;
  while (n < 3) {
    sum = n = 0;
    for (std::size_t i = 0; i < model.points.size(); ++i) {
      if ((model.points[i] - mark).norm() > reach) continue;
      const Vec3 q = pose.to_scan(model.point(i, pose.shape));
      skin.tree.nearest(q, 1, found);
      const bool like = skin.normals[found[0].point].dot(pose.rotation * model.normals[i]) > 0.2;
      sum += like ? std::min(std::sqrt(found[0].distance2), kWorst) : kWorst;
      ++n;
    }
    reach *= 1.5;
  }
  return std::clamp(1 - sum / n / kWorst, 0.0, 1.0);
}

}  // namespace palpate::landmarks
