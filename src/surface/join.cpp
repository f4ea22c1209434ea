// SPDX-License-Identifier: GPL-3.0-or-later
// A closed surface that runs near both pieces gives the topology, the pieces give the shape: its
// points go onto them, and only where they leave a gap does it stay.
#include "surface/join.hpp"

#include "core/error.hpp"
#include "surface/conform.hpp"
#include "surface/query.hpp"
#include "surface/remesh.hpp"
#include "surface/untangle.hpp"

namespace palpate::surface {
namespace {

constexpr int kIterations = 5;  // of remeshing, as repair does
// [edges] A face with its middle farther than this from both pieces bridges a gap.
constexpr double kBridge = 0.5;

SurfaceMesh both(const SurfaceMesh& first, const SurfaceMesh& second) {
  SurfaceMesh soup = first;
  const auto shift = static_cast<std::int32_t>(first.points.size());
  soup.points.insert(soup.points.end(), second.points.begin(), second.points.end());
  for (const auto& [a, b, c] : second.triangles)
    soup.triangles.push_back({a + shift, b + shift, c + shift});
  return soup;
}

SurfaceMesh with_bridges(const SurfaceMesh& soup, const SurfaceMesh& around, double farther) {
  const SurfaceQuery query(soup);
  SurfaceMesh bridges{around.points, {}};
  for (const Triangle& t : around.triangles) {
    const Vec3 middle = (around.points[t[0]] + around.points[t[1]] + around.points[t[2]]) / 3;
    if (query.closest(middle).distance > farther) bridges.triangles.push_back(t);
  }
  return both(soup, bridges);
}

std::vector<SurfaceSample> samples_of(const SurfaceMesh& soup) {
  std::vector<SurfaceSample> samples;
  const std::vector<Vec3> normal = triangle_normals(soup);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    const auto& [a, b, c] = soup.triangles[t];
    samples.push_back({(soup.points[a] + soup.points[b] + soup.points[c]) / 3, normal[t]});
    samples.push_back({soup.points[a], normal[t]});
  }
  return samples;
}

}  // namespace

JoinedSurface join_surfaces(const SurfaceMesh& first, const SurfaceMesh& second,
                            const SurfaceMesh& around, double edge, const Progress& progress) {
  progress.step("joining surfaces", 0);
  const SurfaceMesh soup = both(first, second);
  CornerMesh m = corner_mesh(around);
  thin(m, 0.5 * edge, progress);
  remesh(m, SurfaceQuery(with_bridges(soup, around, kBridge * edge)), edge, kIterations, progress);
  conform(m, samples_of(soup), edge, progress);
  if (!untangle(m, edge, progress))
    throw InputError("two surfaces to be joined pass through each other; a whole head is needed");
  JoinedSurface joined{m.to_surface(), {}};
  const SurfaceQuery query(soup);
  for (const Vec3& p : joined.mesh.points) joined.nearest.push_back(query.closest(p).triangle);
  return joined;
}

}  // namespace palpate::surface
