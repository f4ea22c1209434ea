// SPDX-License-Identifier: GPL-3.0-or-later
// The openness of a point is the cosine-weighted share of its hemisphere through which a ray leaves
// the surface for good (ambient occlusion; Zhukov, Iones & Kronin 1998). A convex point has 1, the
// bottom of a deep well 0. On a face the folds beside the nose and behind the ears stay above 0.4;
// the insides of eye sockets, mouth and nostrils are below 0.2 but for their rims.
#include "surface/pockets.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "surface/query.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;

// [-] Faces below it may belong to a pocket. Lower leaves deeper rims; at 0.4 and above ear folds
// are closed too.
constexpr double kOpenness = 0.3;
// [-] Area of a pocket over the area of its openings. A hemisphere has 2: what is shallower is a
// dent of the skin, to be kept.
constexpr double kPocketRatio = 2.0;
// Directions over the sphere: the share is then known to about 0.04 on a rim.
constexpr int kDirections = 128;
// [-] cosine: flatter rays graze the surface's own facets.
constexpr double kGrazing = 0.1;
// [edge lengths] Rays start this far off the surface, beyond the facets' sagitta.
constexpr double kLift = 0.1;

// Fibonacci lattice: nearly even, and the same on every machine.
std::vector<Vec3> sphere_directions() {
  std::vector<Vec3> directions;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2.0 * i + 1) / kDirections, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return directions;
}

std::vector<double> openness(const CornerMesh& m, double edge, const Progress& progress) {
  const SurfaceMesh surface = m.to_surface();
  const SurfaceQuery query(surface);
  const std::vector<Vec3> normal = vertex_normals(surface), directions = sphere_directions();
  std::vector<double> open(m.points.size());
  tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t v) {
    if (v % 1024 == 0) progress.step("finding pockets", static_cast<double>(v) / open.size());
    const Vec3 start = m.points[v] + kLift * edge * normal[v];
    double seen = 0, all = 0;
    for (const Vec3& d : directions) {
      const double cosine = d.dot(normal[v]);
      if (cosine < kGrazing) continue;
      all += cosine;
      if (!query.blocked(start, d)) seen += cosine;
    }
    open[v] = all > 0 ? seen / all : 1;
  });
  return open;
}

// Mean over each face's corners and their neighbours: a rim that does not zigzag.
std::vector<std::uint8_t> shaded_faces(const CornerMesh& m, const std::vector<double>& open) {
  std::vector<double> smooth(open.size());
  for (std::size_t v = 0; v < open.size(); ++v) {
    double sum = open[v];
    int n = 1;
    m.around(static_cast<Id>(v), [&](Id h) { sum += open[m.to(h)], ++n; });
    smooth[v] = sum / n;
  }
  std::vector<std::uint8_t> shaded(m.faces());
  for (Id f = 0; f < m.faces(); ++f) {
    double mean = 0;
    for (Id h = 3 * f; h < 3 * f + 3; ++h) mean += smooth[m.from(h)] / 3;
    shaded[f] = mean < kOpenness;
  }
  return shaded;
}

// Area of the openings of a region (flag 2): the vector areas of its border loops.
double opening_area(const CornerMesh& m, const std::vector<Id>& region,
                    const std::vector<std::uint8_t>& flag) {
  const auto inside = [&](Id h) { return flag[h / 3] == 2; };
  const auto border = [&](Id h) { return inside(h) && !inside(m.twin[h]); };
  std::vector<std::uint8_t> seen(3 * region.size(), 0);
  std::vector<Id> sides;
  for (const Id f : region)
    for (Id h = 3 * f; h < 3 * f + 3; ++h)
      if (border(h)) sides.push_back(h);
  std::sort(sides.begin(), sides.end());
  const auto index = [&](Id h) {
    return std::lower_bound(sides.begin(), sides.end(), h) - sides.begin();
  };
  double area = 0;
  for (const Id start : sides) {
    Vec3 twice = Vec3::Zero();
    const Vec3 origin = m.points[m.from(start)];
    for (Id h = start; !seen[index(h)];) {
      seen[index(h)] = 1;
      twice += (m.points[m.from(h)] - origin).cross(m.points[m.to(h)] - origin);
      h = CornerMesh::next(h);
      while (inside(m.twin[h])) h = CornerMesh::next(m.twin[h]);
    }
    area += 0.5 * twice.norm();
  }
  return area;
}

}  // namespace

Pockets find_pockets(const CornerMesh& m, double edge, const Progress& progress) {
  std::vector<std::uint8_t> flag = shaded_faces(m, openness(m, edge, progress));
  Pockets pockets;
  pockets.face.assign(m.faces(), 0);
  std::vector<Id> region;
  for (Id seed = 0; seed < m.faces(); ++seed) {
    if (flag[seed] != 1) continue;
    region.assign(1, seed);
    flag[seed] = 2;
    double area = 0;
    for (std::size_t i = 0; i < region.size(); ++i) {
      area += 0.5 * m.area_vector(3 * region[i]).norm();
      for (Id h = 3 * region[i]; h < 3 * region[i] + 3; ++h) {
        const Id g = m.twin[h] / 3;
        if (flag[g] == 1) flag[g] = 2, region.push_back(g);
      }
    }
    const bool pocket = area >= kPocketRatio * opening_area(m, region, flag);
    pockets.count += pocket;
    for (const Id f : region) flag[f] = 0, pockets.face[f] = pocket;
  }
  return pockets;
}

}  // namespace palpate::surface
