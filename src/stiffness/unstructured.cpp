// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/unstructured.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.hpp"
#include "stiffness/piece_mesh.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kReach = 4;        // [-] tool radii from the site; 5 changes thick tissue by 1 %
constexpr double kUnderTool = 1.2;  // [-] tool radii within which edges are shortest
// Against edges of 0.35 tool radii growing by 0.6, without joining (60 000 unknowns instead of
// 14 000), at four sites beside folds: 0.5 % at 5 N, 2.2 % at 0.5 N, a fifteenth of the time.
constexpr double kShortest = 0.6;         // [-] tool radii: largest edge there
constexpr double kGrowth = 1.5;           // [-] of the distance beyond: largest edge there
constexpr double kTouch = 1.7;            // [-] tool radii from the site: skin that may be met
constexpr std::size_t kMostTets = 20000;  // bounds the memory of one site

/// Largest edge [mm] at a point of the piece.
double wanted_edge(const Vec3& at, double tool_radius) {
  const double beyond = std::max(at.norm() - kUnderTool * tool_radius, 0.0);
  return kShortest * tool_radius + kGrowth * beyond;
}

fem::TetMesh linear_mesh(const TissuePiece& piece) {
  fem::TetMesh mesh;
  mesh.nodes = piece.nodes;
  for (const Tetrahedron& t : piece.tets) mesh.tets.insert(mesh.tets.end(), t.begin(), t.end());
  return mesh;
}

/// Skin that the tissue mesh holds (ears, lips) would carry the tool like stone; patches leave it
/// free too. A piece without bone hangs on its cut.
void hold_bone_only(TissuePiece& piece) {
  for (std::size_t n = 0; n < piece.nodes.size(); ++n) piece.held[n] &= !piece.skin[n];
  if (std::count(piece.held.begin(), piece.held.end(), 1) > 0) return;
  const fem::FaceList faces = fem::boundary_faces(linear_mesh(piece));
  for (std::size_t f = 0; f < faces.size(); f += 3)
    if (!piece.skin[faces[f]] || !piece.skin[faces[f + 1]] || !piece.skin[faces[f + 2]])
      for (int i = 0; i < 3; ++i) piece.held[faces[f + i]] = 1;
}

LocalBody finish(const TissuePiece& piece, double tool_radius) {
  LocalBody body;
  body.mesh = fem::to_quadratic(linear_mesh(piece));
  const fem::FaceList faces = fem::boundary_faces(body.mesh);
  const int stride = fem::face_nodes(body.mesh.order);
  body.held = piece.held;
  body.held.resize(body.mesh.nodes.size(), 0);
  for (std::size_t f = 0; f < faces.size(); f += stride)
    if (piece.held[faces[f]] && piece.held[faces[f + 1]] && piece.held[faces[f + 2]])
      for (int i = 3; i < stride; ++i) body.held[faces[f + i]] = 1;
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
  const auto size = [tool_radius](const Vec3& at) { return wanted_edge(at, tool_radius); };
  PieceMesh mesh(std::move(taken));
  mesh.coarsen(size, kTouch * tool_radius);
  mesh.refine(size, kMostTets);
  return finish(mesh.piece(), tool_radius);
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
