// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of one round: D(x) = max_k w_k(x) * sum_k w_k d_k / sum_k w_k with w_k(x) =
// exp(-|x - x_k|^2 / 2 r^2), d_k the push that point k needs. With |d_k| <= kShortest r the map
// x + D(x) is invertible (its gradient's norm stays below about 2 |d| / r < 1), and so is a
// sequence of such maps. Each round at least halves what the worst point lacks unless skin lies on
// the other side too; then the reach is narrowed.
#include "skull/clearance.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace palpate::skull {
namespace {

constexpr double kShortest = 0.3;  ///< [-] longest push over the reach
constexpr double kFade = 3.0;      ///< [-] reaches beyond which a push is not felt (1 %)

struct Push {
  Vec3 at, by;
};

std::vector<Push> needed_pushes(const std::vector<Vec3>& points, const SkinField& skin,
                                double wanted, double longest, double threshold) {
  std::vector<double> depth(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t i) { depth[i] = skin.depth(points[i]); });
  std::vector<Push> pushes;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (depth[i] < threshold)
      pushes.push_back(
          {points[i], std::min(wanted - depth[i], longest) * skin.at(points[i]).gradient});
  return pushes;
}

Vec3 motion(const Vec3& x, const std::vector<Push>& pushes, double reach) {
  const double far2 = kFade * kFade * reach * reach;
  Vec3 sum = Vec3::Zero();
  double total = 0, most = 0;
  for (const Push& push : pushes) {
    const double d2 = (x - push.at).squaredNorm();
    if (d2 > far2) continue;
    const double w = std::exp(-0.5 * d2 / (reach * reach));
    sum += w * push.by;
    total += w;
    most = std::max(most, w);
  }
  return total > 0 ? Vec3(most / total * sum) : Vec3::Zero();
}

Box grown_box(const std::vector<Push>& pushes, double by) {
  std::vector<Vec3> at;
  for (const Push& p : pushes) at.push_back(p.at);
  Box box = bounding_box(at);
  box.low.array() -= by;
  box.high.array() += by;
  return box;
}

bool holds(const Box& box, const Vec3& p) {
  return (p.array() >= box.low.array()).all() && (p.array() <= box.high.array()).all();
}

}  // namespace

ClearanceReport keep_clear(std::vector<Vec3>& points, std::vector<Vec3>& riders,
                           const SkinField& skin, const ClearanceOptions& options,
                           const Progress& progress) {
  ClearanceReport report;
  const std::vector<Vec3> first = points;
  bool counted = false;
  for (double reach = options.reach; reach >= options.least_reach; reach /= 2) {
    for (int round = 0; round < options.rounds_per_reach; ++round) {
      progress.step("fit", 0.85);
      const std::vector<Push> pushes =
          needed_pushes(points, skin, options.clearance + 2 * options.margin, kShortest * reach,
                        options.clearance + options.margin);
      if (!counted) report.pushed = pushes.size();
      counted = true;
      if (pushes.empty()) {
        for (std::size_t i = 0; i < points.size(); ++i)
          report.largest_push = std::max(report.largest_push, (points[i] - first[i]).norm());
        return report;
      }
      const Box box = grown_box(pushes, kFade * reach);
      for (std::vector<Vec3>* list : {&points, &riders})
        for (Vec3& p : *list)
          if (holds(box, p)) p += motion(p, pushes, reach);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    report.largest_push = std::max(report.largest_push, (points[i] - first[i]).norm());
    report.remaining += skin.depth(points[i]) < options.clearance;
  }
  return report;
}

}  // namespace palpate::skull
