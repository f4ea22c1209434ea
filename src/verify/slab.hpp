// SPDX-License-Identifier: GPL-3.0-or-later
// A round slab of tissue bonded to a rigid floor: the scene of most comparisons.
#pragma once
#include "fem/elastic_body.hpp"
#include "fem/tet_mesh.hpp"

namespace palpate::verify {

struct SlabRule {
  std::vector<double> rings;   ///< [mm] radii, ascending
  int sectors = 12;            ///< of every ring
  std::vector<double> depths;  ///< [mm] of the levels, from 0 to the thickness
  double touch_radius = 0;     ///< [mm] top faces that an indenter may meet
  bool hold_rim = false;
  /// Nodes in the middle of edges lie where polar coordinates put them, so that rings are circles
  /// (quadratic meshes; needs an isoparametric element).
  bool round = false;
};
/// Top at z = 0, middle of the top at node 0, floor held.
struct Slab {
  fem::TetMesh mesh;
  std::vector<std::uint8_t> held;  ///< one per node
  fem::FaceList touchable;         ///< top faces within the touch radius
};
[[nodiscard]] Slab make_slab(const SlabRule& rule, fem::ElementOrder order);

/// Levels from the top down: the first one `first` thick, each next `growth` times thicker, scaled
/// so that the last one ends at `thickness`.
[[nodiscard]] std::vector<double> graded_depths(double thickness, double first, double growth);

}  // namespace palpate::verify
