// SPDX-License-Identifier: GPL-3.0-or-later
// A piece of the head's tetrahedra made as fine as a press needs: short edges under the tool, long
// ones far from it.
#pragma once
#include <array>
#include <functional>

#include "stiffness/unstructured.hpp"

namespace palpate::stiffness {

/// Linear tetrahedra that are joined and bisected edge by edge, conforming at every step.
class PieceMesh {
 public:
  explicit PieceMesh(TissuePiece piece);

  /// Largest edge wanted [mm] with its middle at a point.
  using Size = std::function<double(const Vec3&)>;

  /// Moves one end of a short edge onto the other, the shortest first by its share of `size`, where
  /// no tetrahedron is inverted, flattened or made longer than wanted and the boundary moves by
  /// less than a twelfth of its distance from the origin. Borders between skin, held faces and cut
  /// stay borders.
  /// @param keep  boundary within this distance [mm] of the origin is left as it is
  /// @cite Garland & Heckbert 1997, "Surface simplification using quadric error metrics", for the
  /// order; Dey et al. 1999, "Topology preserving edge contraction", for the link condition
  void coarsen(const Size& size, double keep);
  /// Bisects edges longer than `size`, the longest first, with all tetrahedra around them, until
  /// there are `most` tetrahedra.
  /// @cite Rivara 1984, "Mesh refinement processes based on the generalized bisection of simplices"
  void refine(const Size& size, std::size_t most);
  /// Without the tetrahedra and nodes that are gone; node 0 stays node 0.
  [[nodiscard]] TissuePiece piece() const;

 private:
  using Edge = std::pair<std::int32_t, std::int32_t>;  // smaller number first
  using Face = std::array<std::int32_t, 3>;            // ascending
  static Edge edge_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

  [[nodiscard]] double length(const Edge& e) const;
  [[nodiscard]] Vec3 middle(const Edge& e) const;
  [[nodiscard]] std::vector<std::int32_t> star(std::int32_t node) const;
  [[nodiscard]] std::vector<std::int32_t> ring(const Edge& e) const;
  [[nodiscard]] std::vector<std::int32_t> neighbours(std::int32_t node) const;
  /// Faces with this node that belong to one tetrahedron only.
  [[nodiscard]] std::vector<Face> boundary(std::int32_t node) const;
  /// 1 skin, 2 held, 4 neither.
  [[nodiscard]] int kind_of(const Face& f) const;
  [[nodiscard]] bool may_follow_boundary(std::int32_t gone, std::int32_t kept, double keep,
                                         double tolerance) const;
  [[nodiscard]] bool same_link(std::int32_t gone, std::int32_t kept) const;
  [[nodiscard]] bool stays_sound(std::int32_t gone, std::int32_t kept, const Size& size) const;
  void join(std::int32_t gone, std::int32_t kept);
  void bisect(const Edge& e, const std::vector<std::int32_t>& around);

  TissuePiece piece_;                            // a tetrahedron that is gone has -1 first
  std::vector<std::vector<std::int32_t>> tets_;  // per node; may hold tets that have left it
};

}  // namespace palpate::stiffness
