// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/conform.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "surface/query.hpp"
#include "surface/remesh.hpp"

namespace palpate::surface {

namespace {

using Id = CornerMesh::Id;

constexpr int kRounds = 6;        // the offset shrinks by about half each time
constexpr double kReach = 0.5;    // [edge lengths] a sample farther off belongs to another fold
constexpr double kFacing = 0.7;   // [-] cosine (45 degrees), for the same reason
constexpr double kLargest = 0.2;  // [edge lengths] in all: the sagitta where r is 0.6 edge lengths;
                                  // beyond that single points would chase details as spikes
constexpr int kBlendSweeps = 3;   // a step at a rim is then spread over about two edges

template <class Value>
Value ring_mean(const CornerMesh& m, Id v, const std::vector<Value>& value, Value sum) {
  int n = 0;
  m.around(v, [&](Id h) { sum += value[m.to(h)], ++n; });
  return sum / n;
}

// Mean offset [mm] of the samples along each point's normal; 0 where there are none.
std::vector<double> mean_offsets(const CornerMesh& m, const std::vector<SurfaceSample>& samples,
                                 double reach, const std::vector<Vec3>& normal) {
  const SurfaceQuery query(m.to_surface());
  std::vector<ClosestPoint> foot(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(),
                    [&](std::size_t i) { foot[i] = query.closest(samples[i].point, reach); });
  std::vector<double> offset(m.points.size(), 0), weight(m.points.size(), 0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (foot[i].triangle < 0) continue;
    const Id h = 3 * foot[i].triangle;
    if (m.area_vector(h).stableNormalized().dot(samples[i].normal) < kFacing) continue;
    for (int k = 0; k < 3; ++k) {
      const Id v = m.corner[h + k];
      offset[v] += foot[i].barycentric[k] * normal[v].dot(samples[i].point - foot[i].point);
      weight[v] += foot[i].barycentric[k];
    }
  }
  for (std::size_t v = 0; v < offset.size(); ++v)
    if (weight[v] > 0) offset[v] /= weight[v];
  return offset;
}

}  // namespace

std::vector<std::uint8_t> near_covers(const CornerMesh& m) {
  std::vector<std::uint8_t> cover(m.points.size(), 0);
  for (Id h = 0; h < m.half_edges(); ++h)
    if (m.patch[h / 3] == kCover) cover[m.from(h)] = 1;
  std::vector<std::uint8_t> near = cover;
  for (Id h = 0; h < m.half_edges(); ++h)
    if (cover[m.from(h)]) near[m.to(h)] = 1;
  return near;
}

void conform(CornerMesh& m, const std::vector<SurfaceSample>& samples, double edge,
             const Progress& progress) {
  const std::vector<std::uint8_t> held = near_covers(m);
  std::vector<double> moved(m.points.size(), 0);
  for (int round = 0; round < kRounds; ++round) {
    progress.step("fitting the working surface", static_cast<double>(round) / kRounds);
    const std::vector<Vec3> normal = vertex_normals(m.to_surface());
    const std::vector<double> offset = mean_offsets(m, samples, kReach * edge, normal);
    for (std::size_t v = 0; v < m.points.size(); ++v) {
      if (held[v]) continue;
      const auto id = static_cast<Id>(v);
      const double step = 0.5 * (offset[v] + ring_mean(m, id, offset, 0.0));
      const double limited = std::clamp(moved[v] + step, -kLargest * edge, kLargest * edge);
      const Vec3 p = m.points[v] + (limited - moved[v]) * normal[v];
      if (!keeps_direction(m, id, p)) continue;
      m.points[v] = p;
      moved[v] = limited;
    }
  }
}

void blend_covers(CornerMesh& m) {
  const std::vector<std::uint8_t> moves = near_covers(m);
  for (int sweep = 0; sweep < kBlendSweeps; ++sweep) {
    const std::vector<Vec3> old = m.points;
    for (std::size_t v = 0; v < old.size(); ++v)
      if (moves[v]) m.points[v] = ring_mean(m, static_cast<Id>(v), old, Vec3(Vec3::Zero()));
  }
}

}  // namespace palpate::surface
