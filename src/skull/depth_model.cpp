// SPDX-License-Identifier: GPL-3.0-or-later
// The table gives depths at points; bone between them needs a depth too. Two facts carry most of
// it. On the vault the scalp is nearly even, and muscle (temporalis, nuchal muscles) fills the
// hollows of the skull flush with its convex hull: depth = scalp + distance to the hull. On the
// face the landmarks are dense and their depths vary over a few centimetres: kriging (a Gaussian
// process with known noise) interpolates them and says how far to trust the result away from them.
#include "skull/depth_model.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "surface/query.hpp"

namespace palpate::skull {
namespace {

/// [mm] depth far from every landmark, on the vault and elsewhere, before the table is looked at,
/// and how little that is worth beside it: a table without a landmark on one part stays solvable.
constexpr double kVaultDepth = 5.5;
constexpr double kFaceDepth = 10.0;
constexpr double kLevelDoubt = 10.0;
/// [-] share of the distance to the hull that flesh fills on the face: cheeks are hollow.
constexpr double kFaceFill = 0.3;
/// [mm] doubt of the scalp rule on the even vault, and its growth per mm of hollow [-].
constexpr double kVaultDoubt = 1.0;
constexpr double kHollowDoubt = 0.3;
/// [-] difference of unit normals over which bone faces count as strangers: the inside of the jaw
/// learns nothing from its outside.
constexpr double kNormalRange = 0.8;
/// [landmarks] that the table's typical variation is worth beside the SDs of those nearby.
constexpr double kTypicalWeight = 0.1;
constexpr double kUsualVariation = 0.3;  ///< [-] SD over mean of a table without SDs
/// [mm] least target depth: skin alone.
constexpr double kLeastMean = 2.5;
/// [mm] how far bone is looked for in front of bone.
constexpr double kShadowReach = 80;

bool on_vault(SkullRegion r) {
  return r == SkullRegion::cranium || r == SkullRegion::forehead;
}

struct Site {
  Vec3 position, normal;
  double gap;
  bool vault;
};

/// [mm] of flesh that the hollow of the skull holds at a site.
double fill(const Site& s) {
  return s.vault ? s.gap : kFaceFill * s.gap;
}

/// [mm] how far depths stray from level and fill: little on the vault, the table's spread
/// elsewhere.
double stray(const Site& s, const DepthModelOptions& o) {
  return s.vault ? std::min(o.spread, kVaultDoubt + kHollowDoubt * s.gap) : o.spread;
}

double correlation(const Site& a, const Site& b, const DepthModelOptions& o) {
  const double far = (a.position - b.position).squaredNorm() / (2 * o.range * o.range);
  const double turned = (a.normal - b.normal).squaredNorm() / (2 * kNormalRange * kNormalRange);
  return std::exp(-far - turned);
}

/// Depth = level (one of the vault, one of the rest) + fill + a Gaussian process, with the levels
/// estimated from the same landmarks (universal kriging: generalised least squares).
class Kriging {
 public:
  struct Value {
    double mean = 0;    ///< [mm]
    double doubt = 0;   ///< [mm] of the interpolation
    double weight = 0;  ///< [landmarks] that lie around
    double sd = 0;      ///< [mm] between individuals, sum of theirs by weight
  };
  Kriging(std::vector<Site> known, const std::vector<LandmarkTarget>& landmarks,
          const DepthModelOptions& options)
      : known_(std::move(known)), options_(options) {
    const auto n = static_cast<Eigen::Index>(known_.size());
    Eigen::MatrixXd gram(n, n);
    Eigen::MatrixX2d part = Eigen::MatrixX2d::Zero(n, 2);
    Eigen::VectorXd above(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      part(i, known_[i].vault ? 0 : 1) = 1;
      above[i] = landmarks[i].mean - fill(known_[i]);
      sd_.push_back(landmarks[i].sd);
      for (Eigen::Index j = 0; j < n; ++j)
        gram(i, j) = stray(known_[i], options_) * stray(known_[j], options_) *
                     correlation(known_[i], known_[j], options_);
      gram(i, i) += options_.nugget * options_.nugget;
    }
    inverse_ = gram.llt().solve(Eigen::MatrixXd::Identity(n, n));
    const Eigen::Vector2d before(kVaultDepth, kFaceDepth);
    const double worth = 1 / (kLevelDoubt * kLevelDoubt);
    Eigen::Matrix2d normal = part.transpose() * inverse_ * part;
    normal.diagonal().array() += worth;
    level_ = normal.ldlt().solve(part.transpose() * inverse_ * above + worth * before);
    solved_ = inverse_ * (above - part * level_);
  }
  [[nodiscard]] Value at(const Site& site) const {
    const auto n = static_cast<Eigen::Index>(known_.size());
    const double own = stray(site, options_);
    Eigen::VectorXd k(n);
    double weight = 0, sd = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double share = correlation(site, known_[i], options_);
      k[i] = own * stray(known_[i], options_) * share;
      weight += share;
      sd += share * sd_[i];
    }
    const double left = own * own - k.dot(inverse_ * k);
    return {level_[site.vault ? 0 : 1] + fill(site) + k.dot(solved_),
            std::sqrt(std::max(0.0, left)), weight, sd};
  }

 private:
  std::vector<Site> known_;
  DepthModelOptions options_;
  std::vector<double> sd_;
  Eigen::MatrixXd inverse_;
  Eigen::Vector2d level_;
  Eigen::VectorXd solved_;
};

std::vector<Site> vertex_sites(const SkullTemplate& skull) {
  const std::vector<Vec3> normals = vertex_normals(skull.mesh);
  const std::vector<double> gaps = hull_gaps(skull.mesh);
  std::vector<Site> sites;
  for (std::size_t i = 0; i < normals.size(); ++i)
    sites.push_back({skull.mesh.points[i], normals[i], gaps[i], on_vault(skull.region[i])});
  return sites;
}

std::vector<double> visible_area(const SurfaceMesh& mesh, const std::vector<Site>& sites) {
  std::vector<double> area(sites.size(), 0.0);
  for (const Triangle& t : mesh.triangles) {
    const double a = (mesh.points[t[1]] - mesh.points[t[0]])
                         .cross(mesh.points[t[2]] - mesh.points[t[0]])
                         .norm() /
                     6;
    for (const std::int32_t v : t) area[v] += a;
  }
  const surface::SurfaceQuery query(mesh);
  tbb::parallel_for(std::size_t{0}, sites.size(), [&](std::size_t i) {
    if (query.cast(sites[i].position + 0.5 * sites[i].normal, sites[i].normal, kShadowReach))
      area[i] = 0;
  });
  return area;
}

}  // namespace

const TissueDepth* find_depth(const std::vector<TissueDepth>& table, const std::string& code) {
  const std::string plain = code.substr(0, code.find('_'));
  for (const TissueDepth& row : table)
    if (row.code == plain) return &row;
  return nullptr;
}

double typical_variation(const std::vector<TissueDepth>& table) {
  std::vector<double> all;
  for (const TissueDepth& row : table)
    if (row.sd_mm > 0 && row.mean_mm > 0) all.push_back(row.sd_mm / row.mean_mm);
  if (all.empty()) return kUsualVariation;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

std::vector<double> hull_gaps(const SurfaceMesh& mesh) {
  // The hull is the intersection of its supporting half-spaces; 2000 directions are 5 degrees
  // apart, which misses the hull of a skull (radius 100 mm) by 0.1 mm.
  constexpr int kDirections = 1000;
  std::vector<double> gaps(mesh.points.size(), 1e300);
  for (int i = 0; i < kDirections; ++i) {
    const double up = 1 - (2 * i + 1.0) / kDirections;  // Fibonacci sphere
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * i, r = std::sqrt(1 - up * up);
    // Paired with its mirror image, so that a symmetric skull gets symmetric gaps.
    for (const double side : {1.0, -1.0}) {
      const Vec3 direction(side * r * std::cos(turn), up, r * std::sin(turn));
      double support = -1e300;
      for (const Vec3& p : mesh.points) support = std::max(support, direction.dot(p));
      for (std::size_t v = 0; v < gaps.size(); ++v)
        gaps[v] = std::min(gaps[v], support - direction.dot(mesh.points[v]));
    }
  }
  return gaps;
}

DepthModel make_depth_model(const SkullTemplate& skull, const std::vector<TissueDepth>& table,
                            const DepthModelOptions& options) {
  const std::vector<Site> sites = vertex_sites(skull);
  const double typical = typical_variation(table);
  DepthModel model;
  std::vector<Site> known;
  for (const auto& [code, landmark] : skull.landmarks) {
    const TissueDepth* row = find_depth(table, code);
    if (!row) continue;
    model.landmarks.push_back({code, landmark.position, row->mean_mm,
                               row->sd_mm > 0 ? row->sd_mm : typical * row->mean_mm});
    const auto nearest = std::min_element(sites.begin(), sites.end(), [&](auto& a, auto& b) {
      return (a.position - landmark.position).squaredNorm() <
             (b.position - landmark.position).squaredNorm();
    });
    known.push_back({landmark.position, landmark.normal, nearest->gap, nearest->vault});
  }
  if (known.empty())
    throw InputError("the skull template carries no landmark of the soft-tissue depth table");

  const Kriging table_field(known, model.landmarks, options);
  model.area = visible_area(skull.mesh, sites);
  for (const Site& site : sites) {
    const Kriging::Value at = table_field.at(site);
    model.mean.push_back(std::max(kLeastMean, at.mean));
    // Hollows of the vault are the skull's own: what differs between people is the scalp.
    const double flesh = std::max(kLeastMean, at.mean - (site.vault ? site.gap : 0));
    const double people = (at.sd + kTypicalWeight * typical * flesh) / (at.weight + kTypicalWeight);
    model.sd.push_back(std::hypot(people, at.doubt));
  }
  return model;
}

}  // namespace palpate::skull
