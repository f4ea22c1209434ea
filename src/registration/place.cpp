// SPDX-License-Identifier: GPL-3.0-or-later
// Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Cryst. A32 (1976)
// and A34 (1978); Umeyama, "Least-squares estimation of transformation parameters between two
// point patterns", IEEE TPAMI 13 (1991).
#include "registration/place.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "registration/cut.hpp"

namespace palpate::registration {
namespace {

constexpr std::array<const char*, 5> kPublishedPairs = {
    "nose_tip", "nose_corner_left", "nose_corner_right", "eye_outer_left", "eye_outer_right"};
/// [-] second singular value of the covariance over the first, below which the pairs lie on a line.
constexpr double kLineRatio = 1e-9;
/// [mm] a scan whose cap lies less than this below the nose tip has no chin; from nose tip to
/// menton an adult measures 60 to 80 mm, a small child 45 mm.
constexpr double kLeastNoseToChin = 40;

struct Moments {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  // weighted means
  Mat3 covariance = Mat3::Zero();               // of (to, from)
  double spread = 0;                            // weighted mean square distance of `from`
};

Moments moments(std::span<const PointPair> pairs) {
  Moments m;
  double total = 0;
  for (const PointPair& p : pairs) total += p.weight;
  if (pairs.size() < 3 || total <= 0)
    throw InputError(fmt::format(
        "placement needs three pairs of points or more, but there are {}; give the missing "
        "landmarks with --landmark name=x,y,z",
        pairs.size()));
  for (const PointPair& p : pairs) {
    m.from += p.weight / total * p.from;
    m.to += p.weight / total * p.to;
  }
  for (const PointPair& p : pairs) {
    const double w = p.weight / total;
    m.covariance += w * (p.to - m.to) * (p.from - m.from).transpose();
    m.spread += w * (p.from - m.from).squaredNorm();
  }
  return m;
}

Placement solve(std::span<const PointPair> pairs, bool with_scale) {
  const Moments m = moments(pairs);
  const Eigen::JacobiSVD<Mat3> svd(m.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 d = svd.singularValues();
  if (!(d[1] > kLineRatio * d[0]))
    throw InputError(
        "the pairs of points lie on one line, so no rotation follows from them; give landmarks "
        "off that line with --landmark name=x,y,z");
  // The best orthogonal matrix is U V^T; where it mirrors, the least important axis is turned back.
  Vec3 sign(1, 1, 1);
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
  const Mat3 rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double scale = with_scale ? d.dot(sign) / m.spread : 1.0;
  Placement place;
  place.linear = scale * rotation;
  place.translation = m.to - place.linear * m.from;
  return place;
}

void set_residuals(Placement& place, std::span<const PointPair> pairs) {
  double sum = 0, total = 0;
  for (const PointPair& p : pairs) {
    const double left = (p.to - place(p.from)).norm();
    place.residuals_mm[p.name] = left;
    sum += p.weight * left * left;
    total += p.weight;
  }
  place.rms_mm = std::sqrt(sum / total);
}

bool trimmed_away(const HeadSurface& head, std::size_t i) {
  return i < head.region.size() &&
         (head.region[i] == SkinRegion::ear || head.region[i] == SkinRegion::neck);
}

Box box_without_ears_and_neck(const HeadSurface& head, const ScanEnds& ends) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < head.skin.points.size(); ++i)
    if (!trimmed_away(head, i) && !ends.no_scan[i]) kept.push_back(head.skin.points[i]);
  if (kept.empty()) throw InputError("the head has no skin besides ears and neck");
  return bounding_box(kept);
}

}  // namespace

Placement fit_rigid(std::span<const PointPair> pairs) {
  Placement place = solve(pairs, false);
  set_residuals(place, pairs);
  return place;
}

Placement fit_similarity(std::span<const PointPair> pairs) {
  Placement place = solve(pairs, true);
  set_residuals(place, pairs);
  return place;
}

std::vector<PointPair> shared_pairs(const HeadSurface& head, const SkullTemplate& skull) {
  std::vector<PointPair> pairs;
  for (const auto& [name, landmark] : head.landmarks)
    if (const auto at = skull.registration_points.find(name); at != skull.registration_points.end())
      pairs.push_back({name, at->second, landmark.position});
  return pairs;
}

Placement place_published(const HeadSurface& head, const SkullTemplate& skull) {
  const ScanEnds ends = find_scan_ends(head);
  const Box on_head = box_without_ears_and_neck(head, ends);
  Vec3 scale = on_head.size().cwiseQuotient(bounding_box(skull.mesh.points).size());
  Placement place;
  if (const auto tip = head.landmarks.find("nose_tip");
      tip != head.landmarks.end() &&
      tip->second.position.y() - on_head.low.y() < kLeastNoseToChin) {
    scale.y() = 0.5 * (scale.x() + scale.z());
    place.warnings.push_back(
        "the scan ends above the chin: the template's vertical scale is the mean of the other two");
  }
  std::vector<PointPair> pairs;
  for (const char* name : kPublishedPairs) {
    const auto to = head.landmarks.find(name);
    const auto from = skull.registration_points.find(name);
    if (to == head.landmarks.end() || from == skull.registration_points.end())
      throw InputError(fmt::format(
          "the published placement needs the point {0} on head and template; give it with "
          "--landmark {0}=x,y,z",
          name));
    pairs.push_back({name, scale.cwiseProduct(from->second), to->second.position});
  }
  const Placement rigid = fit_rigid(pairs);
  place.linear = rigid.linear * scale.asDiagonal();
  place.translation = rigid.translation;
  place.residuals_mm = rigid.residuals_mm;
  place.rms_mm = rigid.rms_mm;
  return place;
}

Placement place_similarity(const HeadSurface& head, const SkullTemplate& skull) {
  return fit_similarity(shared_pairs(head, skull));
}

SkullTemplate placed(SkullTemplate skull, const Placement& placement) {
  const Mat3 cofactor = placement.linear.inverse().transpose();  // takes normals to normals
  for (Vec3& p : skull.mesh.points) p = placement(p);
  for (auto& [code, landmark] : skull.landmarks) {
    landmark.position = placement(landmark.position);
    landmark.normal = (cofactor * landmark.normal).stableNormalized();
  }
  for (auto& [name, point] : skull.registration_points) point = placement(point);
  return skull;
}

}  // namespace palpate::registration
