// SPDX-License-Identifier: GPL-3.0-or-later
// The press where the skin under the tool is no height field (a fold, the edge of an ear or a lip):
// on a piece cut out of the head's own tetrahedra, refined towards the tool.
#pragma once
#include "core/tissue_mesh.hpp"
#include "stiffness/site.hpp"

namespace palpate::stiffness {

/// A piece of the head in a site's frame, quadratic.
struct LocalBody {
  fem::TetMesh mesh;
  std::vector<std::uint8_t> held;  ///< one per node
  fem::FaceList touchable;         ///< skin faces that the tool may meet
};

/// Tetrahedra of the head as they are, in a site's frame; node 0 is skin, the nearest to the site.
struct TissuePiece {
  std::vector<Vec3> nodes;
  std::vector<std::uint8_t> held, skin;  ///< one per node
  std::vector<Tetrahedron> tets;         ///< flesh
};

/// Cuts pieces out of one tissue mesh; made once per head.
class TissueCutter {
 public:
  /// @param tissue  must outlive the object
  explicit TissueCutter(const TissueMesh& tissue);

  /// Flesh connected to the skin at the site within four tool radii of it, its edges made as long
  /// as the press allows: 0.6 tool radii under the tool, growing with the distance. Bone is held,
  /// skin never; where the piece has no bone, its cut is.
  /// @throws SolveError  where no flesh lies at the site
  [[nodiscard]] LocalBody cut(const SiteFrame& frame, double tool_radius) const;

  enum class Start { any, free };  ///< whether node 0 may be held
  /// Flesh connected to node 0 whose tetrahedra have their centre within `reach` of the site; the
  /// cut is free.
  /// @param near  [mm] within which node 0 must lie
  /// @throws SolveError  where no flesh lies at the site
  [[nodiscard]] TissuePiece take(const SiteFrame& frame, double reach, double near,
                                 Start start) const;

 private:
  const TissueMesh& tissue_;
  std::vector<std::vector<std::int32_t>> tets_of_;  // flesh tets per node
};

/// Sphere from first contact along the inward normal, in double precision.
/// @param ring_radii  [mm] where dents are measured
[[nodiscard]] SiteCurve press_unstructured(const LocalBody& body,
                                           std::shared_ptr<const fem::EnergyDensity> law,
                                           const Tool& tool, std::span<const double> forces,
                                           std::span<const double> ring_radii);

}  // namespace palpate::stiffness
