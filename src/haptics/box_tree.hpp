// SPDX-License-Identifier: Apache-2.0
// A tree of boxes over triangles for the tick: flat, four children a node, single precision.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
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
  static constexpr int kMostBalls = 3;
  /// Boxes wholly inside one of the balls are not visited.
  struct Except {
    std::array<Vec3, kMostBalls> centers;
    int count = 0;
    double radius = 0;  ///< [mm]
  };

  BoxTree() = default;
  /// `mesh` must be free of defects. Also returns the order of the leaves: put triangles into this
  /// order before visiting, since the visitor is given positions in it.
  [[nodiscard]] static std::pair<BoxTree, std::vector<std::int32_t>> build(const SurfaceMesh& mesh);

  /// Calls visit(triangle) -> squared radius [mm^2] that still interests, for every triangle whose
  /// box comes within the current radius of p, near boxes first.
  template <class Visit>
  void visit_near(const Vec3& p, double radius2, Visit&& visit) const {
    traverse<false>(p, radius2, {}, visit);
  }
  template <class Visit>
  void visit_near(const Vec3& p, double radius2, const Except& except, Visit&& visit) const {
    traverse<true>(p, radius2, except, visit);
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
  [[nodiscard]] static Lanes larger(Lanes a, Lanes b) {
    return a > b ? a : b;
  }

  template <bool kExcept, class Visit>
  void traverse(const Vec3& p, double radius2, const Except& except, Visit& visit) const;

  friend class BoxTreeBuilder;
  std::vector<Node> nodes_;
  Vec3 center_ = Vec3::Zero();
  Box box_{};
};

template <bool kExcept, class Visit>
void BoxTree::traverse(const Vec3& p, double radius2, const Except& except, Visit& visit) const {
  constexpr float kGrow = 1.00001F;    // rounding of the squared distances
  constexpr double kFarthest2 = 1e30;  // [mm^2] finite, so that unused lanes stay out
  const Eigen::Vector3f q = (p - center_).cast<float>();
  float bound = static_cast<float>(std::min(radius2, kFarthest2)) * kGrow;
  std::array<Eigen::Vector3f, kMostBalls> balls;
  const auto inside2 = static_cast<float>(except.radius * except.radius);
  if constexpr (kExcept)
    for (int s = 0; s < except.count; ++s) balls[s] = (except.centers[s] - center_).cast<float>();

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
    const std::array<float, 3> at = turned(node, q);
    Lanes distance2{};
    for (int k = 0; k < 3; ++k) {
      const Lanes outside = larger(larger(node.low[k] - at[k], at[k] - node.high[k]), Lanes{});
      distance2 += outside * outside;
    }
    if constexpr (kExcept)
      for (int s = 0; s < except.count; ++s) {
        const std::array<float, 3> ball = turned(node, balls[s]);
        Lanes farthest2{};
        for (int k = 0; k < 3; ++k) {
          const Lanes reach = larger(ball[k] - node.low[k], node.high[k] - ball[k]);
          farthest2 += reach * reach;
        }
        distance2 = farthest2 < inside2 ? Lanes{} + std::numeric_limits<float>::max() : distance2;
      }
    const Lanes limit = Lanes{} + bound;
    alignas(16) std::array<float, kWidth> near2;
    std::memcpy(near2.data(), &distance2, sizeof(distance2));
    const int first = top;
    for (int open = lanes_within(distance2, limit); open != 0; open &= open - 1) {
      const int lane = std::countr_zero(static_cast<unsigned>(open));
      int place = top++;  // farthest lowest, so that the nearest is popped first
      for (; place > first && stack[place - 1].distance2 < near2[lane]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {near2[lane], node.child[lane]};
    }
  }
}

}  // namespace palpate::haptics
