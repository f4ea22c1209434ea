// SPDX-License-Identifier: Apache-2.0
// A tree of boxes over triangles for the tick: flat, eight children a node, single precision.
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
using Quad = float __attribute__((vector_size(16)));
/// Eight numbers, as two chains of four: a step down the tree waits for results, not for units.
struct Lanes {
  Quad low, high;
};

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
  static constexpr int kWidth = 8;
  // Six cache lines, those first that tell whether the rest is read. child >= 0 is a node, < 0 the
  // triangle ~child; an unused lane has low = +inf, which is farther than anything.
  struct alignas(64) Node {
    std::array<Quad, 3> column;  // of the orthonormal axes, which are the rows; lane 3 is 0
    std::array<Lanes, 3> low, high;
    std::array<std::int32_t, kWidth> child;
    // Largest angle between the node's third axis and a triangle's normal in the box; cosine -2
    // where a border makes contacts in any direction possible.
    Lanes spread_cosine, spread_sine;
    // What lanes_same() can find at all: the most facing box and the smallest. Large boxes hold
    // nothing that is all the same, and need not be asked.
    float best_spread_cosine, least_half_diagonal2;
  };
  // A balanced eight-way tree over 2^30 triangles is 11 deep; each level leaves at most 7 behind.
  static constexpr int kStack = 128;

  [[nodiscard]] static Quad turned(const Node& node, const Eigen::Vector3f& q) {
    return node.column[0] * q[0] + node.column[1] * q[1] + node.column[2] * q[2];
  }
  [[nodiscard]] static Quad larger(Quad a, Quad b) {
#ifdef __SSE__
    return _mm_max_ps(a, b);  // compilers write the other with a mask
#else
    return a > b ? a : b;
#endif
  }
  [[nodiscard]] static int quad_within(Quad a, Quad b) {
#ifdef __SSE__
    return _mm_movemask_ps(_mm_cmple_ps(a, b));
#else
    int bits = 0;
    for (int k = 0; k < 4; ++k) bits |= a[k] <= b[k] ? 1 << k : 0;
    return bits;
#endif
  }
  /// Bit k is set where a[k] <= b.
  [[nodiscard]] static int lanes_within(const Lanes& a, float b) {
    return quad_within(a.low, Quad{} + b) | quad_within(a.high, Quad{} + b) << 4;
  }
  /// From a point in the node's axes to its boxes.
  [[nodiscard]] static Lanes distances2(const Node& node, Quad at) {
    Lanes sum{};
    for (int k = 0; k < 3; ++k) {
      const Lanes &low = node.low[k], &high = node.high[k];
      const Quad a = larger(larger(low.low - at[k], at[k] - high.low), Quad{});
      const Quad b = larger(larger(low.high - at[k], at[k] - high.high), Quad{});
      sum.low += a * a;
      sum.high += b * b;
    }
    return sum;
  }
  /// Bit k is set where box k holds nothing that is another contact than this one: it lies wholly
  /// within the ball about its point, or all its triangles face the same way.
  [[nodiscard]] static int lanes_same(const Node& node, const Eigen::Vector3f& point,
                                      const Eigen::Vector3f& normal, float apart2, float cosine) {
    const Quad ball = turned(node, point);
    Lanes farthest2{};
    for (int k = 0; k < 3; ++k) {
      const Quad a = larger(ball[k] - node.low[k].low, node.high[k].low - ball[k]);
      const Quad b = larger(ball[k] - node.low[k].high, node.high[k].high - ball[k]);
      farthest2.low += a * a;
      farthest2.high += b * b;
    }
    const int inside = lanes_within(farthest2, apart2);
    const float facing = turned(node, normal)[2];
    if (!(facing > 0)) return inside;
    const float across = std::sqrt(std::max(0.0F, 1 - facing * facing));
    const Lanes &c = node.spread_cosine, &s = node.spread_sine;
    const Quad least = Quad{} + cosine;
    return inside | quad_within(least, facing * c.low - across * s.low) |
           quad_within(least, facing * c.high - across * s.high) << 4;
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
  constexpr float kGrow = 1.00001F;  // rounding of the squared distances
  // [mm] Farther places are searched from here, nearer to every triangle: finite in single
  // precision, also squared, so that unused lanes stay out.
  constexpr double kFarthest = 1e12;
  constexpr double kFarthest2 = 1e30;
  const Eigen::Vector3f q = (p - center_).cwiseMax(-kFarthest).cwiseMin(kFarthest).cast<float>();
  float bound = static_cast<float>(std::min(radius2, kFarthest2)) * kGrow;

  // A squared distance in the upper half and a child in the lower: the bits of floats above zero
  // are in the order of the floats.
  std::array<std::uint64_t, kStack> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint64_t entry = stack[--top];
    if (std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32)) > bound) continue;
    const auto child = static_cast<std::int32_t>(static_cast<std::uint32_t>(entry));
    if (child < 0) {
      bound = static_cast<float>(visit(~child)) * kGrow;
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(child)];
    const Lanes distance2 = distances2(node, turned(node, q));
    alignas(16) std::array<std::uint32_t, kWidth> near2;
    std::memcpy(near2.data(), &distance2, sizeof(distance2));
    const int first = top;
    for (int open = lanes_within(distance2, bound); open != 0; open &= open - 1) {
      const int lane = std::countr_zero(static_cast<unsigned>(open));
      const std::uint64_t next = static_cast<std::uint64_t>(near2[lane]) << 32 |
                                 static_cast<std::uint32_t>(node.child[lane]);
      int place = top++;  // farthest lowest, so that the nearest is popped first
      for (; place > first && stack[place - 1] < next; --place) stack[place] = stack[place - 1];
      stack[place] = next;
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
  const float widest2 = static_cast<float>(rest.radius * rest.radius) * kGrow;
  float reach2 = widest2;
  const float near2 = static_cast<float>(rest.distance2) * kGrow;
  const auto apart2 = static_cast<float>(rest.apart * rest.apart);
  const auto cosine = static_cast<float>(rest.cosine);

  // A child, doubled, plus 1 where it may be another contact: what is written at once is read back
  // at once, without waiting for memory.
  std::array<std::int32_t, kStack> stack;
  int top = 0;
  stack[top++] = 1;
  while (top > 0) {
    const std::int32_t item = stack[--top];
    const std::int32_t child = item >> 1;
    const bool other = (item & 1) != 0;
    if (child < 0) {
      const double wanted = visit(~child, other);
      if (wanted < 0) return;
      reach2 = static_cast<float>(wanted) * kGrow;
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(child)];
    const Lanes distance2 = distances2(node, turned(node, proxy));
    const int within = lanes_within(distance2, widest2);
    if (within == 0) continue;
    int others = other ? within & lanes_within(distance2, reach2) : 0;
    if (node.best_spread_cosine >= cosine || node.least_half_diagonal2 <= apart2)
      for (int j = 0; j < rest.count && others != 0; ++j)
        others &= ~lanes_same(node, points[j], normals[j], apart2, cosine);
    // What is no other contact may still be nearer to the tool; that ball lies within the proxy.
    int open = others;
    if (others != within && rest.distance2 >= 0)
      open |= within & lanes_within(distances2(node, turned(node, tool)), near2);
    for (; open != 0; open &= open - 1) {
      const int lane = std::countr_zero(static_cast<unsigned>(open));
      stack[top++] = 2 * node.child[lane] + ((others >> lane) & 1);
    }
  }
}

}  // namespace palpate::haptics
