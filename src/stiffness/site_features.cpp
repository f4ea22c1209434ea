// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/site_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::stiffness {
namespace {

constexpr int kProbeSectors = 8;
constexpr double kMostCurved =
    1.5;  // [-] tool radius over radius of curvature; folds are cut there

std::vector<std::vector<std::int32_t>> triangles_of_points(const SurfaceMesh& mesh) {
  std::vector<std::vector<std::int32_t>> of(mesh.points.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t]) of[v].push_back(static_cast<std::int32_t>(t));
  return of;
}

/// Mean and harmonic sizes of samples around a ring.
struct Harmonics {
  double mean = 0, first = 0, second = 0;
  explicit Harmonics(std::span<const double> samples) {
    const double n = static_cast<double>(samples.size());
    double c1 = 0, s1 = 0, c2 = 0, s2 = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double a = 2 * std::numbers::pi * static_cast<double>(i) / n;
      mean += samples[i] / n;
      c1 += 2 / n * samples[i] * std::cos(a), s1 += 2 / n * samples[i] * std::sin(a);
      c2 += 2 / n * samples[i] * std::cos(2 * a), s2 += 2 / n * samples[i] * std::sin(2 * a);
    }
    first = std::hypot(c1, s1);
    second = std::hypot(c2, s2);
  }
};

}  // namespace

namespace {
/// Triangles connected to a point within a radius, with their smooth weights.
class SkinDisk {
 public:
  SkinDisk(const SurfaceMesh& skin, double radius)
      : skin_(skin),
        around_(triangles_of_points(skin)),
        seen_(skin.triangles.size(), -1),
        radius_(radius) {
    for (const Triangle& t : skin.triangles) {
      const Vec3 &a = skin.points[t[0]], &b = skin.points[t[1]], &c = skin.points[t[2]];
      area_normal.push_back(0.5 * (b - a).cross(c - a));
      center_.push_back((a + b + c) / 3);
    }
  }
  /// visit(triangle, weight) with weight (1 - (r/radius)^2)^2, without the area.
  template <class Visit>
  void around(std::size_t point, const Visit& visit) {
    const auto mark = static_cast<std::int32_t>(point);
    queue_ = around_[point];
    for (const std::int32_t t : queue_) seen_[t] = mark;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::int32_t now = queue_[i];
      const double q = 1 - (center_[now] - skin_.points[point]).squaredNorm() / (radius_ * radius_);
      if (q <= 0) continue;
      visit(now, q * q);
      for (const std::int32_t v : skin_.triangles[now])
        for (const std::int32_t t : around_[v])
          if (seen_[t] != mark) seen_[t] = mark, queue_.push_back(t);
    }
  }
  std::vector<Vec3> area_normal;  ///< [mm^2] per triangle

 private:
  const SurfaceMesh& skin_;
  std::vector<std::vector<std::int32_t>> around_;
  std::vector<Vec3> center_;
  std::vector<std::int32_t> seen_, queue_;
  double radius_;
};
}  // namespace

std::vector<Vec3> smoothed_normals(const SurfaceMesh& skin, double radius) {
  SkinDisk disk(skin, radius);
  std::vector<Vec3> out = vertex_normals(skin);
  for (std::size_t p = 0; p < skin.points.size(); ++p) {
    Vec3 sum = 1e-9 * out[p];
    disk.around(p, [&](std::int32_t t, double weight) { sum += weight * disk.area_normal[t]; });
    out[p] = sum.normalized();
  }
  return out;
}

std::vector<double> smoothed_over_skin(const SurfaceMesh& skin, std::span<const double> value,
                                       double radius) {
  SkinDisk disk(skin, radius);
  std::vector<double> out(value.begin(), value.end());
  for (std::size_t p = 0; p < skin.points.size(); ++p) {
    double sum = 1e-9 * value[p], weights = 1e-9;
    disk.around(p, [&](std::int32_t t, double weight) {
      const Triangle& v = skin.triangles[t];
      const double w = weight * disk.area_normal[t].norm();
      sum += w * (value[v[0]] + value[v[1]] + value[v[2]]) / 3;
      weights += w;
    });
    out[p] = sum / weights;
  }
  return out;
}

std::optional<SiteFeatures> site_features(const SiteFrame& frame, double tool_radius,
                                          const surface::SurfaceQuery& skin,
                                          const surface::SurfaceQuery& bone,
                                          const SamplingLimits& limits) {
  std::vector<Ring> rings;
  for (const double share : kProbeRings) rings.push_back({share * tool_radius, kProbeSectors});
  const std::vector<Column> columns = make_columns(rings);
  const PatchGeometry g = sample_patch(columns, tool_radius, frame, skin, bone, limits);
  if (g.thickness[0] >= limits.no_bone_beyond) return std::nullopt;

  SiteFeatures f;
  f.depth = g.thickness[0];
  f.shape.resize(1 + 5 * static_cast<int>(rings.size()));
  f.shape[0] = std::log(f.depth / tool_radius);
  for (std::size_t r = 0; r < rings.size(); ++r) {
    std::array<double, kProbeSectors> thickness, height;
    for (int s = 0; s < kProbeSectors; ++s) {
      thickness[s] = std::log(g.thickness[1 + r * kProbeSectors + s] / tool_radius);
      height[s] = std::clamp(g.height[1 + r * kProbeSectors + s] * 2 * tool_radius /
                                 (rings[r].radius * rings[r].radius),
                             -kMostCurved, kMostCurved);
    }
    const Harmonics t(thickness), h(height);
    f.shape.segment<5>(1 + 5 * static_cast<int>(r)) << t.mean, t.first, t.second, h.mean, h.second;
  }
  return f;
}

bool leaves_tissue(const SiteFrame& frame, double depth, const surface::SurfaceQuery& skin) {
  constexpr double kBelowSkin = 0.2;  // [mm] the ray starts inside
  if (depth <= 2 * kBelowSkin) return false;
  return skin.cast(frame.origin - kBelowSkin * frame.normal(), -frame.normal(), depth - kBelowSkin)
      .has_value();
}

}  // namespace palpate::stiffness
