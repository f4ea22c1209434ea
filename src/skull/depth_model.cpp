// SPDX-License-Identifier: GPL-3.0-or-later
// The table gives depths at points; bone between them needs a depth too. Two facts carry most of
// it. On the vault the scalp is nearly even, and muscle (temporalis, nuchal muscles) fills the
// hollows of the skull flush with its convex hull: depth = scalp + distance to the hull. On the
// face the landmarks are dense and their depths vary over a few centimetres: kriging (a Gaussian
// process with known noise) interpolates them and says how far to trust the result away from them.
#include "skull/depth_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "surface/query.hpp"

namespace palpate::skull {
namespace {

/// [mm] mean depth far from every landmark, on the vault and elsewhere: the table's medians there.
constexpr double kVaultDepth = 5.5;
constexpr double kFaceDepth = 10.0;
/// [-] share of the distance to the hull that flesh fills on the face: cheeks are hollow.
constexpr double kFaceFill = 0.3;
/// [mm] doubt of the scalp rule on the even vault, and its growth per mm of hollow [-].
constexpr double kVaultDoubt = 1.0;
constexpr double kHollowDoubt = 0.3;
/// [-] difference of unit normals over which bone faces count as strangers: the inside of the jaw
/// learns nothing from its outside.
constexpr double kNormalRange = 0.8;
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

double base_depth(const Site& s) {
  return s.vault ? kVaultDepth + s.gap : kFaceDepth + kFaceFill * s.gap;
}

double kernel(const Site& a, const Site& b, const DepthModelOptions& o) {
  const double far = (a.position - b.position).squaredNorm() / (2 * o.range * o.range);
  const double turned = (a.normal - b.normal).squaredNorm() / (2 * kNormalRange * kNormalRange);
  return o.spread * o.spread * std::exp(-far - turned);
}

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
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (query.cast(sites[i].position + 0.5 * sites[i].normal, sites[i].normal, kShadowReach))
      area[i] = 0;
  return area;
}

}  // namespace

const TissueDepth* find_depth(const std::vector<TissueDepth>& table, const std::string& code) {
  const std::string plain = code.substr(0, code.find('_'));
  for (const TissueDepth& row : table)
    if (row.code == plain) return &row;
  return nullptr;
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
  DepthModel model;
  std::vector<Site> known;
  for (const auto& [code, landmark] : skull.landmarks) {
    const TissueDepth* row = find_depth(table, code);
    if (!row) continue;
    model.landmarks.push_back(
        {code, landmark.position, row->mean_mm, row->sd_mm > 0 ? row->sd_mm : options.unknown_sd});
    const auto nearest = std::min_element(sites.begin(), sites.end(), [&](auto& a, auto& b) {
      return (a.position - landmark.position).squaredNorm() <
             (b.position - landmark.position).squaredNorm();
    });
    known.push_back({landmark.position, landmark.normal, nearest->gap, nearest->vault});
  }
  if (known.empty())
    throw InputError("the skull template carries no landmark of the soft-tissue depth table");

  const auto n = static_cast<Eigen::Index>(known.size());
  Eigen::MatrixXd gram(n, n);
  Eigen::VectorXd above(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    above[i] = model.landmarks[i].mean - base_depth(known[i]);
    for (Eigen::Index j = 0; j < n; ++j) gram(i, j) = kernel(known[i], known[j], options);
    gram(i, i) += options.nugget * options.nugget;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(gram);
  const Eigen::VectorXd solved = factor.solve(above);
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));

  model.area = visible_area(skull.mesh, sites);
  for (const Site& site : sites) {
    Eigen::VectorXd k(n);
    double near = 1e-12, spread = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      k[i] = kernel(site, known[i], options);
      const double share = k[i] + 1e-6;
      near += share;
      spread += share * model.landmarks[i].sd;
    }
    double doubt = std::sqrt(std::max(0.0, options.spread * options.spread - k.dot(inverse * k)));
    if (site.vault) doubt = std::min(doubt, kVaultDoubt + kHollowDoubt * site.gap);
    model.mean.push_back(std::max(kLeastMean, base_depth(site) + k.dot(solved)));
    model.sd.push_back(std::hypot(spread / near, doubt));
  }
  return model;
}

}  // namespace palpate::skull
