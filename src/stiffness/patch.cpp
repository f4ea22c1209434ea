// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/patch.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::stiffness {
namespace {

constexpr double kAboveSkin = 0.01;       // [mm] rays start above the highest skin they may meet
constexpr double kSteepestGrading = 2.5;  // [-] exponent of the layer rule; more flattens elements

struct Sampler {
  const SiteFrame& frame;
  const surface::SurfaceQuery& skin;
  const surface::SurfaceQuery& bone;
  const SamplingLimits& limits;

  Vec3 world(const Column& c, double z) const {
    return frame.origin + frame.axes * Vec3(c.x, c.y, z);
  }

  struct Seen {
    double height;
    SkinSpot spot;
  };
  /// The skin over column c within `reach` of `near`; nothing where it is not seen from outside
  /// there.
  std::optional<Seen> see_skin(const Column& c, double near, double reach) const {
    const double top = near + reach + kAboveSkin;
    const auto hit = skin.cast(world(c, top), -frame.normal(), 2 * (reach + kAboveSkin));
    if (!hit || !faces_out(hit->triangle)) return std::nullopt;
    return Seen{top - hit->distance, {hit->triangle, hit->barycentric}};
  }

  bool faces_out(std::int32_t triangle) const {
    const auto& m = skin.mesh();
    const Triangle& v = m.triangles[triangle];
    const Vec3 n = (m.points[v[1]] - m.points[v[0]]).cross(m.points[v[2]] - m.points[v[0]]);
    return n.dot(frame.normal()) > 0;
  }

  /// The skin that was not seen: below, when the column's bound is outside the head; above
  /// otherwise.
  double bound(const Column& c, double near, double reach) const {
    return skin.signed_distance(world(c, near - reach)) > 0 ? near - reach : near + reach;
  }

  double bone_depth(const Column& c, double height) const {
    const auto hit = bone.cast(world(c, height), -frame.normal(), limits.no_bone_beyond);
    return hit ? hit->distance : limits.no_bone_beyond;
  }
};

}  // namespace

SiteFrame site_frame(const Vec3& origin, const Vec3& outward_normal) {
  constexpr double kNearlyParallel = 0.9;  // [-] cosine of 25 degrees
  const Vec3 n = outward_normal.normalized();
  const Vec3 up = std::abs(n.y()) < kNearlyParallel ? Vec3::UnitY() : Vec3::UnitZ();
  SiteFrame f;
  f.origin = origin;
  f.axes.col(0) = (up - up.dot(n) * n).normalized();
  f.axes.col(1) = n.cross(f.axes.col(0));
  f.axes.col(2) = n;
  return f;
}

PatchGeometry sample_patch(std::span<const Column> columns, double near_radius,
                           const SiteFrame& frame, const surface::SurfaceQuery& skin,
                           const surface::SurfaceQuery& bone, const SamplingLimits& limits) {
  const Sampler sampler{frame, skin, bone, limits};
  PatchGeometry g;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Column& c = columns[i];
    const double near = i == 0 ? 0 : g.height[c.inner];
    const double step = i == 0 ? 1 : std::hypot(c.x - columns[c.inner].x, c.y - columns[c.inner].y);
    const auto seen = sampler.see_skin(c, near, limits.skin_slope * step);
    const double height = seen ? seen->height : sampler.bound(c, near, limits.skin_slope * step);
    g.spot.push_back(seen ? seen->spot : i > 0 ? g.spot[c.inner] : SkinSpot{});
    if (!seen) ++(std::hypot(c.x, c.y) <= near_radius ? g.bent : g.bent_far);

    double depth = sampler.bone_depth(c, height);
    if (depth >= limits.no_bone_beyond) ++g.boneless;
    if (i > 0) {
      const double bone_near = g.height[c.inner] - g.thickness[c.inner];
      depth = std::min(depth, height - bone_near + limits.bone_slope * step);
    }
    g.height.push_back(height);
    g.thickness.push_back(std::max(depth, limits.least_thickness));
  }
  return g;
}

std::vector<Vec3> patch_nodes(const PatchTemplate& t, const PatchGeometry& g, double first_layer,
                              std::span<const double> levels) {
  const int layers = t.rule.layers;
  std::vector<Vec3> nodes;
  nodes.reserve(t.topology.free_node.size());
  for (std::size_t c = 0; c < t.columns.size(); ++c) {
    // Depth of level l is thickness * (l / layers)^p with the first layer no thicker than wished.
    double p = 1;
    if (layers > 1 && g.thickness[c] > layers * first_layer)
      p = std::min(std::log(g.thickness[c] / first_layer) / std::log(layers), kSteepestGrading);
    for (int level = 0; level <= layers; ++level) {
      const double share =
          levels.empty() ? std::pow(static_cast<double>(level) / layers, p) : levels[level];
      nodes.push_back({t.columns[c].x, t.columns[c].y, g.height[c] - g.thickness[c] * share});
    }
  }
  for (const auto& [a, b] : t.edges) nodes.push_back(0.5 * (nodes[a] + nodes[b]));
  return nodes;
}

}  // namespace palpate::stiffness
