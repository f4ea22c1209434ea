// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle mesh that can be edited: half-edges with implicit next, for repair and remeshing.
#pragma once
#include <cstdint>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::surface {

/// What a face stands for. A cap closes a large opening, such as the neck: its rim is where the
/// scan ends and is kept sharp. A cover closes a small hole or a pocket in the middle of the skin:
/// its rim is blended.
enum Patch : std::uint8_t { kScan = 0, kCap = 1, kCover = 2 };

/// Half-edge h belongs to face h / 3 and runs from corner[h] to corner[next(h)]. An oriented
/// 2-manifold, with or without border: each point has one fan of faces.
struct CornerMesh {
  using Id = std::int32_t;
  static constexpr Id kNone = -1;

  std::vector<Vec3> points;
  std::vector<Id> corner;           ///< 3 per face; kNone for a removed face
  std::vector<Id> twin;             ///< the same edge seen from the other face; kNone on a border
  std::vector<Id> out;              ///< one per point: a half-edge that leaves it (the first of the
                                    ///< fan on a border); kNone for a removed point
  std::vector<std::uint8_t> patch;  ///< one per face: see Patch

  static Id next(Id h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Id prev(Id h) { return h % 3 == 0 ? h + 2 : h - 1; }
  [[nodiscard]] Id from(Id h) const { return corner[h]; }
  [[nodiscard]] Id to(Id h) const { return corner[next(h)]; }
  [[nodiscard]] Id apex(Id h) const { return corner[prev(h)]; }
  /// The next half-edge that leaves the same point, counter-clockwise; kNone beyond a border.
  [[nodiscard]] Id turn(Id h) const { return twin[prev(h)]; }
  [[nodiscard]] Id faces() const { return static_cast<Id>(corner.size() / 3); }
  [[nodiscard]] Id half_edges() const { return static_cast<Id>(corner.size()); }
  [[nodiscard]] bool alive(Id h) const { return corner[h] != kNone; }
  [[nodiscard]] double length2(Id h) const {
    return (points[to(h)] - points[from(h)]).squaredNorm();
  }
  /// An edge between scan and cap.
  [[nodiscard]] bool rim(Id h) const {
    const auto a = patch[h / 3], b = patch[twin[h] / 3];
    return a != b && a != kCover && b != kCover;
  }
  /// Twice the area vector of the face of h.
  [[nodiscard]] Vec3 area_vector(Id h) const {
    const Vec3& a = points[from(h)];
    return (points[to(h)] - a).cross(points[apex(h)] - a);
  }

  /// Calls visit(h) for each half-edge that leaves v, counter-clockwise.
  template <class Visit>
  void around(Id v, Visit&& visit) const {
    const Id first = out[v];
    for (Id h = first; h != kNone;) {
      visit(h);
      h = turn(h);
      if (h == first) break;
    }
  }
  /// Half-edge from a to b, or kNone. Misses the border edge that only b's faces know.
  [[nodiscard]] Id find(Id a, Id b) const;
  [[nodiscard]] bool joined(Id a, Id b) const { return find(a, b) != kNone || find(b, a) != kNone; }
  [[nodiscard]] int valence(Id v) const;  ///< faces around v

  Id add_point(const Vec3& p);
  Id add_face(Id a, Id b, Id c, std::uint8_t in_patch);  ///< twins are left open; see pair()
  void pair(Id h, Id g) { twin[h] = g, twin[g] = h; }

  /// Puts a new point on the edge of h; works on a border. @return the point
  Id split(Id h, const Vec3& p);
  /// The edge of h becomes the other diagonal of its two faces.
  /// @pre can_flip(h)
  void flip(Id h);
  [[nodiscard]] bool can_flip(Id h) const;
  /// Moves the start of h into its end and removes the two faces of the edge; closed meshes only.
  /// @pre can_collapse(h)
  void collapse(Id h);
  [[nodiscard]] bool can_collapse(Id h) const;

  /// A point where several fans of faces meet only at their tips becomes several points. Needs no
  /// `out`, and leaves it stale. @return points added
  std::size_t split_fans();
  /// Removes the flagged faces (one flag per face), then all but the piece with the most faces.
  void remove_faces(const std::vector<std::uint8_t>& flagged);
  /// Every `out` anew from the faces; a border point gets the first half-edge of its fan.
  void rebuild_out();
  /// Removed faces and points are dropped.
  void compact();
  /// Border loops, each as its half-edges in the faces' direction, by ascending first half-edge.
  [[nodiscard]] std::vector<std::vector<Id>> border_loops() const;
  [[nodiscard]] SurfaceMesh to_surface() const;  ///< all points; removed faces left out
};

/// @pre triangles are oriented and at most two share an edge, one each way
[[nodiscard]] CornerMesh corner_mesh(const SurfaceMesh& mesh);

}  // namespace palpate::surface
