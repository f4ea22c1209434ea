// SPDX-License-Identifier: GPL-3.0-or-later
// Bisection of longest edges first keeps angles away from zero: Rivara 1984, "Mesh refinement
// processes based on the generalized bisection of simplices".
#include "stiffness/unstructured.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <set>

#include "core/error.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kReach = 4;        // [-] tool radii from the site; 5 changes thick tissue by 1 %
constexpr double kUnderTool = 1.2;  // [-] tool radii within which edges are shortest
constexpr double kShortest = 0.35;  // [-] tool radii: largest edge there
constexpr double kGrowth = 0.6;     // [-] of the distance beyond: largest edge there
constexpr double kTouch = 1.7;      // [-] tool radii from the site: skin that may be met
constexpr std::size_t kMostTets = 6000;  // bounds time and memory of one site: about a minute

using Edge = std::pair<std::int32_t, std::int32_t>;

Edge edge_of(std::int32_t a, std::int32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// A linear mesh that is refined edge by edge.
class Piece : public TissuePiece {
 public:
  explicit Piece(TissuePiece piece) : TissuePiece(std::move(piece)) {}

  void refine(double tool_radius) {
    around_.resize(nodes.size());
    for (std::size_t t = 0; t < tets.size(); ++t)
      for (const std::int32_t n : tets[t]) around_[n].push_back(static_cast<std::int32_t>(t));
    for (std::size_t t = 0; t < tets.size(); ++t) consider(static_cast<int>(t), tool_radius);
    while (!queue_.empty() && tets.size() < kMostTets) {
      const auto [length, edge] = queue_.top();
      queue_.pop();
      split(edge, tool_radius);
    }
  }

 private:
  static double largest_edge(const Vec3& middle, double tool_radius) {
    const double beyond = std::max(middle.norm() - kUnderTool * tool_radius, 0.0);
    return kShortest * tool_radius + kGrowth * beyond;
  }

  void consider(int tet, double tool_radius) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) {
        const Edge e = edge_of(tets[tet][i], tets[tet][j]);
        const Vec3 &a = nodes[e.first], &b = nodes[e.second];
        const double length = (b - a).norm();
        if (length > largest_edge(0.5 * (a + b), tool_radius)) queue_.push({length, e});
      }
  }

  /// Nothing where the edge is gone already.
  void split(const Edge& e, double tool_radius) {
    std::vector<std::int32_t> ring;
    for (const std::int32_t t : around_[e.first])
      if (std::count(tets[t].begin(), tets[t].end(), e.first) > 0 &&
          std::count(tets[t].begin(), tets[t].end(), e.second) > 0)
        ring.push_back(t);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    if (ring.empty()) return;
    const auto middle = static_cast<std::int32_t>(nodes.size());
    nodes.push_back(0.5 * (nodes[e.first] + nodes[e.second]));
    held.push_back(held[e.first] & held[e.second]);
    skin.push_back(skin[e.first] & skin[e.second]);
    around_.emplace_back();
    for (const std::int32_t t : ring) {
      const auto second = static_cast<std::int32_t>(tets.size());
      tets.push_back(tets[t]);
      std::replace(tets[t].begin(), tets[t].end(), e.second, middle);
      std::replace(tets[second].begin(), tets[second].end(), e.first, middle);
      around_[middle].push_back(t);
      for (const std::int32_t n : tets[second]) around_[n].push_back(second);
      consider(t, tool_radius);
      consider(second, tool_radius);
    }
  }

  std::vector<std::vector<std::int32_t>> around_;  // may hold tets that have left the node
  std::priority_queue<std::pair<double, Edge>> queue_;
};

/// Skin that the tissue mesh holds (ears, lips) would carry the tool like stone; patches leave it
/// free too. A piece without bone hangs on its cut.
void hold_bone_only(TissuePiece& piece) {
  for (std::size_t n = 0; n < piece.nodes.size(); ++n) piece.held[n] &= !piece.skin[n];
  if (std::count(piece.held.begin(), piece.held.end(), 1) > 0) return;
  fem::TetMesh linear;
  linear.nodes = piece.nodes;
  for (const Tetrahedron& t : piece.tets) linear.tets.insert(linear.tets.end(), t.begin(), t.end());
  const fem::FaceList faces = fem::boundary_faces(linear);
  for (std::size_t f = 0; f < faces.size(); f += 3)
    if (!piece.skin[faces[f]] || !piece.skin[faces[f + 1]] || !piece.skin[faces[f + 2]])
      for (int i = 0; i < 3; ++i) piece.held[faces[f + i]] = 1;
}

LocalBody finish(const Piece& piece, double tool_radius) {
  fem::TetMesh linear;
  linear.nodes = piece.nodes;
  for (const Tetrahedron& t : piece.tets) linear.tets.insert(linear.tets.end(), t.begin(), t.end());
  LocalBody body;
  std::vector<std::array<std::int32_t, 2>> edges;
  body.mesh = fem::to_quadratic(linear, &edges);
  body.held = piece.held;
  for (const auto& [a, b] : edges) body.held.push_back(piece.held[a] & piece.held[b]);
  const fem::FaceList faces = fem::boundary_faces(body.mesh);
  const int stride = fem::face_nodes(body.mesh.order);
  for (std::size_t f = 0; f < faces.size(); f += stride) {
    const Vec3 &a = body.mesh.nodes[faces[f]], &b = body.mesh.nodes[faces[f + 1]],
               &c = body.mesh.nodes[faces[f + 2]];
    bool touchable = (b - a).cross(c - a).z() > 0;
    for (int i = 0; i < 3; ++i)
      touchable = touchable && piece.skin[faces[f + i]] &&
                  body.mesh.nodes[faces[f + i]].norm() <= kTouch * tool_radius;
    if (touchable) body.touchable.insert(body.touchable.end(), &faces[f], &faces[f] + stride);
  }
  if (body.touchable.empty()) throw SolveError("the tool meets no skin of the piece");
  return body;
}

/// Corner nodes of the touchable skin by distance from the axis; a ring without nodes repeats the
/// one before.
std::vector<std::vector<std::int32_t>> rings_of(const LocalBody& body,
                                                std::span<const double> radii) {
  std::set<std::int32_t> skin;
  const int stride = fem::face_nodes(body.mesh.order);
  for (std::size_t f = 0; f < body.touchable.size(); f += stride)
    skin.insert(&body.touchable[f], &body.touchable[f] + 3);
  std::vector<std::vector<std::int32_t>> rings(radii.size());
  for (const std::int32_t n : skin) {
    const double r = body.mesh.nodes[n].head<2>().norm();
    std::size_t best = 0;
    for (std::size_t k = 1; k < radii.size(); ++k)
      if (std::abs(radii[k] - r) < std::abs(radii[best] - r)) best = k;
    rings[best].push_back(n);
  }
  for (std::size_t k = 0; k < rings.size(); ++k)
    if (rings[k].empty()) rings[k] = k > 0 ? rings[k - 1] : std::vector{*skin.begin()};
  return rings;
}

}  // namespace

TissueCutter::TissueCutter(const TissueMesh& tissue)
    : tissue_(tissue), tets_of_(tissue.nodes.size()) {
  for (std::size_t t = 0; t < tissue.tets.size(); ++t)
    if (tissue.label[t] == TissueLabel::flesh)
      for (const std::int32_t n : tissue.tets[t])
        tets_of_[n].push_back(static_cast<std::int32_t>(t));
}

TissuePiece TissueCutter::take(const SiteFrame& frame, double reach, double near,
                               Start which) const {
  const auto local = [&](std::int32_t n) -> Vec3 {
    return frame.axes.transpose() * (tissue_.nodes[n] - frame.origin);
  };
  std::int32_t start = -1;
  double nearest = near;
  for (std::size_t n = 0; n < tissue_.skin_points; ++n) {
    const double d = (tissue_.nodes[n] - frame.origin).norm();
    if (which == Start::free && tissue_.held[n]) continue;
    if (d < nearest && !tets_of_[n].empty()) nearest = d, start = static_cast<std::int32_t>(n);
  }
  if (start < 0) throw SolveError("no flesh at the site");

  TissuePiece piece;
  std::map<std::int32_t, std::int32_t> number;
  std::vector<std::int32_t> open;
  std::set<std::int32_t> taken;
  const auto number_of = [&](std::int32_t n) {
    const auto [at, fresh] = number.try_emplace(n, static_cast<std::int32_t>(piece.nodes.size()));
    if (fresh) {
      piece.nodes.push_back(local(n));
      piece.held.push_back(tissue_.held[n] != 0);
      piece.skin.push_back(static_cast<std::size_t>(n) < tissue_.skin_points);
      open.push_back(n);
    }
    return at->second;
  };
  (void)number_of(start);
  for (std::size_t i = 0; i < open.size(); ++i)
    for (const std::int32_t t : tets_of_[open[i]]) {
      Vec3 center = Vec3::Zero();
      for (const std::int32_t n : tissue_.tets[t]) center += 0.25 * local(n);
      if (center.norm() > reach || !taken.insert(t).second) continue;
      Tetrahedron corners;
      for (int k = 0; k < 4; ++k) corners[k] = number_of(tissue_.tets[t][k]);
      piece.tets.push_back(corners);
    }
  if (piece.tets.empty()) throw SolveError("no flesh at the site");
  return piece;
}

LocalBody TissueCutter::cut(const SiteFrame& frame, double tool_radius) const {
  TissuePiece taken = take(frame, kReach * tool_radius, tool_radius, Start::any);
  hold_bone_only(taken);
  Piece piece(std::move(taken));
  piece.refine(tool_radius);
  return finish(piece, tool_radius);
}

SiteCurve press_unstructured(const LocalBody& body, std::shared_ptr<const fem::EnergyDensity> law,
                             const Tool& tool, std::span<const double> forces,
                             std::span<const double> ring_radii) {
  const fem::Topology topology = fem::make_topology(body.mesh, body.held, body.touchable);
  fem::Cholesky cholesky(topology.pattern);
  SiteCurve curve = press_body(topology, body.mesh.nodes, std::move(law), tool, forces,
                               rings_of(body, ring_radii), cholesky);
  curve.method = SolveMethod::unstructured;
  return curve;
}

}  // namespace palpate::stiffness
