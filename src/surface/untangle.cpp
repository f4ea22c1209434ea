// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/untangle.hpp"

#include "surface/holes.hpp"
#include "surface/intersections.hpp"
#include "surface/remesh.hpp"

namespace palpate::surface {
namespace {

using Id = CornerMesh::Id;

constexpr int kSmoothRounds = 6, kCutRounds = 4;  // each reaches one ring further than the last
constexpr int kSweeps = 5;  // of averaging: a fold of one edge is gone after three
// [-] Share of faces that meet others. More is not a spot but a surface that passes through itself.
constexpr double kSpots = 0.02;
// [-] Share of faces that may be cut out in one round.
constexpr double kLargestCut = 0.1;

// Coordinates become single-precision numbers first, so that any file format carries a surface that
// is as free of intersections as this one.
std::vector<std::uint8_t> meeting_faces(CornerMesh& m) {
  for (Vec3& p : m.points) p = p.cast<float>().cast<double>();
  std::vector<std::uint8_t> meets(m.faces(), 0);
  for (const auto& [a, b] : self_intersections(m.to_surface())) meets[a] = meets[b] = 1;
  return meets;
}

std::size_t count(const std::vector<std::uint8_t>& flags) {
  std::size_t n = 0;
  for (const auto f : flags) n += f;
  return n;
}

// Flagged faces and all that share a point with them, `rings` times.
void grow(const CornerMesh& m, std::vector<std::uint8_t>& face, int rings) {
  for (int r = 0; r < rings; ++r) {
    std::vector<std::uint8_t> point(m.points.size(), 0);
    for (Id h = 0; h < m.half_edges(); ++h)
      if (face[h / 3]) point[m.from(h)] = 1;
    for (Id h = 0; h < m.half_edges(); ++h)
      if (point[m.from(h)]) face[h / 3] = 1;
  }
}

void smooth(CornerMesh& m, const std::vector<std::uint8_t>& face) {
  std::vector<std::uint8_t> moves(m.points.size(), 0);
  for (Id h = 0; h < m.half_edges(); ++h)
    if (face[h / 3]) moves[m.from(h)] = 1;
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t v = 0; v < m.points.size(); ++v) {
      if (!moves[v]) continue;
      Vec3 sum = Vec3::Zero();
      int n = 0;
      m.around(static_cast<Id>(v), [&](Id h) { sum += m.points[m.to(h)], ++n; });
      m.points[v] = sum / n;
    }
}

}  // namespace

bool untangle(CornerMesh& m, double edge, const Progress& progress) {
  for (int round = 0; round < kSmoothRounds + kCutRounds; ++round) {
    progress.step("removing self-intersections",
                  static_cast<double>(round) / (kSmoothRounds + kCutRounds));
    std::vector<std::uint8_t> meets = meeting_faces(m);
    const std::size_t n = count(meets);
    if (n == 0) return true;
    if (static_cast<double>(n) > kSpots * m.faces()) return false;
    if (round < kSmoothRounds) {
      grow(m, meets, round / 2);
      smooth(m, meets);
    } else {
      grow(m, meets, 1 + round - kSmoothRounds);
      if (static_cast<double>(count(meets)) > kLargestCut * m.faces()) return false;
      m.remove_faces(meets);
      fill_holes(m, edge, progress);
    }
  }
  return count(meeting_faces(m)) == 0;
}

}  // namespace palpate::surface
