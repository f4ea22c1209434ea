// SPDX-License-Identifier: Apache-2.0
// A tree of boxes over triangles for the tick: flat, four children a node, single precision.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#ifdef __SSE__
#include <xmmintrin.h>
#endif

#include "core/surface_mesh.hpp"

namespace palpate::haptics {

/// Four numbers that are worked on at once (a GCC and Clang vector; SSE on x86-64).
using Lanes = float __attribute__((vector_size(16)));

/// The tree only finds candidates. Boxes are rounded outwards and widened by a bound on the
/// rounding, so that no triangle within the radius is missed; the visitor measures in double.
///
/// Each node has its own axes, the third along the mean normal of its triangles: on a skin, boxes
/// in such axes are flat, and a query above the surface meets a handful of triangles where boxes
/// along the coordinate axes hand it dozens. Visits allocate nothing and may run from several
/// threads at once.
class BoxTree {
 public:
  static constexpr int kMostFlanks = 3;
  /// A sphere that rests on the skin, for visit_others().
  struct Rest {
    Vec3 proxy;                               ///< [mm] the sphere's centre, outside
    double radius = 0;                        ///< [mm]
    std::array<Vec3, kMostFlanks> points{};   ///< [mm] on which it rests
    std::array<Vec3, kMostFlanks> normals{};  ///< [-] unit, from there to the proxy
    int count = 0;                            ///< of them, >= 1
    double apart = 0;                         ///< [mm] others are at least this far from a point
    double cosine = 1;                        ///< [-] and face away by more than this angle
    /// The tool's own centre [mm] and the squared distance from there to the first point: nearer
    /// triangles are asked for as well, unless it is negative.
    Vec3 center = Vec3::Zero();
    double distance2 = -1;  ///< [mm^2]
  };

  BoxTree() = default;
  /// `mesh` must be free of defects; `border` tells which of its triangles touch a border (empty:
  /// none). Also returns the order of the leaves: put triangles into this order before visiting,
  /// since visitors are given positions in it.
  [[nodiscard]] static std::pair<BoxTree, std::vector<std::int32_t>> build(
      const SurfaceMesh& mesh, const std::vector<char>& border = {});

  /// Calls visit(triangle, other) -> squared radius [mm^2] about the proxy that still interests,
  /// negative to stop, for every triangle that may touch the proxy as another contact (`other`), or
  /// be nearer to the tool than the first point. One walk down the tree answers both questions,
  /// since the ball about the tool lies within the proxy.
  template <class Visit>
  void visit_others(const Rest& rest, Visit&& visit) const;

  /// Calls visit(triangle) -> squared radius [mm^2] that still interests, for every triangle whose
  /// box comes within the current radius of p, near boxes first.
  template <class Visit>
  void visit_near(const Vec3& p, double radius2, Visit&& visit) const {
    traverse(p, radius2, visit);
  }

  [[nodiscard]] const Box& box() const { return box_; }
  [[nodiscard]] std::size_t node_count() const { return nodes_.size(); }

 private:
  static constexpr int kWidth = 4;
  // Three cache lines. child >= 0 is a node, < 0 the triangle ~child; an unused lane has low =
  // +inf, which is farther than anything.
  struct alignas(64) Node {
    std::array<Lanes, 3> low;
    std::array<Lanes, 3> high;
    // Largest angle between the node's third axis and a triangle's normal in the box; cosine -2
    // where a border makes contacts in any direction possible.
    Lanes spread_cosine, spread_sine;
    std::array<std::array<float, 3>, 3> axis;  // orthonormal, one per row
    std::array<std::int32_t, kWidth> child;
  };
  struct Entry {
    float distance2;
    std::int32_t child;
  };
  // A balanced four-way tree over 2^31 triangles is 16 deep; each level leaves at most 3 behind.
  static constexpr int kStack = 128;

  [[nodiscard]] static std::array<float, 3> turned(const Node& node, const Eigen::Vector3f& q) {
    std::array<float, 3> out;
    for (int k = 0; k < 3; ++k)
      out[k] = node.axis[k][0] * q[0] + node.axis[k][1] * q[1] + node.axis[k][2] * q[2];
    return out;
  }
  /// Bit k is set where a[k] <= b[k].
  [[nodiscard]] static int lanes_within(Lanes a, Lanes b) {
#ifdef __SSE__
    return _mm_movemask_ps(_mm_cmple_ps(a, b));
#else
    int bits = 0;
    for (int k = 0; k < kWidth; ++k) bits |= a[k] <= b[k] ? 1 << k : 0;
    return bits;
#endif
  }
  /// From a point in the node's axes to its boxes.
  [[nodiscard]] static Lanes distances2(const Node& node, const std::array<float, 3>& at) {
    Lanes sum{};
    for (int k = 0; k < 3; ++k) {
      const Lanes outside = larger(larger(node.low[k] - at[k], at[k] - node.high[k]), Lanes{});
      sum += outside * outside;
    }
    return sum;
  }
  /// Bit k is set where box k holds nothing that is another contact than this one: it lies wholly
  /// within the ball about its point, or all its triangles face the same way.
  [[nodiscard]] static int lanes_same(const Node& node, const Eigen::Vector3f& point,
                                      const Eigen::Vector3f& normal, float apart2, float cosine) {
    const std::array<float, 3> ball = turned(node, point);
    Lanes farthest2{};
    for (int k = 0; k < 3; ++k) {
      const Lanes reach = larger(ball[k] - node.low[k], node.high[k] - ball[k]);
      farthest2 += reach * reach;
    }
    int same = lanes_within(farthest2, Lanes{} + apart2);
    const float facing =
        node.axis[2][0] * normal[0] + node.axis[2][1] * normal[1] + node.axis[2][2] * normal[2];
    if (facing > 0) {
      const float across = std::sqrt(std::max(0.0F, 1 - facing * facing));
      same |=
          lanes_within(Lanes{} + cosine, facing * node.spread_cosine - across * node.spread_sine);
    }
    return same;
  }
  [[nodiscard]] static Lanes larger(Lanes a, Lanes b) {
    return a > b ? a : b;
  }

  template <class Visit>
  void traverse(const Vec3& p, double radius2, Visit& visit) const;

  friend class BoxTreeBuilder;
  std::vector<Node> nodes_;
  Vec3 center_ = Vec3::Zero();
  Box box_{};
};

template <class Visit>
void BoxTree::traverse(const Vec3& p, double radius2, Visit& visit) const {
  constexpr float kGrow = 1.00001F;    // rounding of the squared distances
  constexpr double kFarthest2 = 1e30;  // [mm^2] finite, so that unused lanes stay out
  const Eigen::Vector3f q = (p - center_).cast<float>();
  float bound = static_cast<float>(std::min(radius2, kFarthest2)) * kGrow;

  std::array<Entry, kStack> stack;
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (entry.distance2 > bound) continue;
    if (entry.child < 0) {
      bound = static_cast<float>(visit(~entry.child)) * kGrow;
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(entry.child)];
    const Lanes distance2 = distances2(node, turned(node, q));
    const Lanes limit = Lanes{} + bound;
    alignas(16) std::array<float, kWidth> near2;
    std::memcpy(near2.data(), &distance2, sizeof(distance2));
    const int first = top;
    int open = lanes_within(distance2, limit);
    for (; open != 0; open &= open - 1) {
      const int lane = std::countr_zero(static_cast<unsigned>(open));
      int place = top++;  // farthest lowest, so that the nearest is popped first
      for (; place > first && stack[place - 1].distance2 < near2[lane]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {near2[lane], node.child[lane]};
    }
  }
}

template <class Visit>
void BoxTree::visit_others(const Rest& rest, Visit&& visit) const {
  constexpr float kGrow = 1.00001F;
  const Eigen::Vector3f proxy = (rest.proxy - center_).cast<float>();
  const Eigen::Vector3f tool = (rest.center - center_).cast<float>();
  std::array<Eigen::Vector3f, kMostFlanks> points, normals;
  for (int j = 0; j < rest.count; ++j) {
    points[j] = (rest.points[j] - center_).cast<float>();
    normals[j] = rest.normals[j].cast<float>();
  }
  const Lanes widest2 = Lanes{} + static_cast<float>(rest.radius * rest.radius) * kGrow;
  Lanes reach2 = widest2;
  const Lanes near2 = Lanes{} + static_cast<float>(rest.distance2) * kGrow;
  const auto apart2 = static_cast<float>(rest.apart * rest.apart);
  const auto cosine = static_cast<float>(rest.cosine);

  struct Item {
    std::int32_t child;
    bool other;
  };
  std::array<Item, kStack> stack;
  int top = 0;
  stack[top++] = {0, true};
  while (top > 0) {
    const Item item = stack[--top];
    if (item.child < 0) {
      const double wanted = visit(~item.child, item.other);
      if (wanted < 0) return;
      reach2 = Lanes{} + static_cast<float>(wanted) * kGrow;
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(item.child)];
    const Lanes distance2 = distances2(node, turned(node, proxy));
    const int within = lanes_within(distance2, widest2);
    if (within == 0) continue;
    int others = item.other ? within & lanes_within(distance2, reach2) : 0;
    for (int j = 0; j < rest.count && others != 0; ++j)
      others &= ~lanes_same(node, points[j], normals[j], apart2, cosine);
    // What is no other contact may still be nearer to the tool; that ball lies within the proxy.
    int open = others;
    if (others != within && rest.distance2 >= 0)
      open |= within & lanes_within(distances2(node, turned(node, tool)), near2);
    for (; open != 0; open &= open - 1) {
      const int lane = std::countr_zero(static_cast<unsigned>(open));
      stack[top++] = {node.child[lane], ((others >> lane) & 1) != 0};
    }
  }
}

}  // namespace palpate::haptics
