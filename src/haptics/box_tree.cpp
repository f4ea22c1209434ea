// SPDX-License-Identifier: Apache-2.0
// Splits along the longest side of the box of the centroids into children of nearly equal size; the
// root takes as few as leave every node below it nearly full. A skin is sampled evenly, where the
// surface-area heuristic gains little over the median and costs a sort per axis.
#include "haptics/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace palpate::haptics {

namespace {

// [-] Of the largest centred coordinate: a few dozen roundings of 2^-24, among them those of the
// axes. Wider costs candidates.
constexpr double kFloatSlack = 4e-6;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace

class BoxTreeBuilder {
 public:
  BoxTreeBuilder(const SurfaceMesh& mesh, const std::vector<char>& border, BoxTree& tree)
      : mesh_(mesh), border_(border), tree_(tree) {
    tree_.box_ = bounding_box(mesh.points);
    tree_.center_ = tree_.box_.center();
    slack_ = kFloatSlack * (0.5 * tree_.box_.size().maxCoeff() + 1e-9);
    centroids_.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
      centroids_.push_back((mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3);
    normals_ = triangle_normals(mesh);
    order_.resize(mesh.triangles.size());
    std::iota(order_.begin(), order_.end(), 0);
  }

  std::vector<std::int32_t> run() {
    tree_.nodes_.reserve(order_.size() / 4 + 1);
    add_node(0, order_.size());
    tree_.nodes_.shrink_to_fit();
    return std::move(order_);
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;

  // Into two for `parts` children in all. Ties are broken by the triangle's number, which makes the
  // order independent of the library's selection algorithm.
  std::size_t split(Range range, int parts) {
    Vec3 low = centroids_[order_[range.first]];
    Vec3 high = low;
    for (std::size_t i = range.first; i < range.second; ++i) {
      low = low.cwiseMin(centroids_[order_[i]]);
      high = high.cwiseMax(centroids_[order_[i]]);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto share = static_cast<std::size_t>(parts / 2);
    const std::size_t middle =
        range.first + (range.second - range.first) * share / static_cast<std::size_t>(parts);
    const auto begin = order_.begin();
    const auto less = [&](std::int32_t a, std::int32_t b) {
      const double ca = centroids_[a][axis];
      const double cb = centroids_[b][axis];
      return ca != cb ? ca < cb : a < b;
    };
    std::nth_element(begin + static_cast<std::ptrdiff_t>(range.first),
                     begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(range.second), less);
    return middle;
  }

  void divide(Range range, int parts, std::vector<Range>& out) {
    if (parts == 1) {
      out.push_back(range);
      return;
    }
    const std::size_t middle = split(range, parts);
    divide({range.first, middle}, parts / 2, out);
    divide({middle, range.second}, parts - parts / 2, out);
  }

  // Children of a node over `count` triangles: one each at the bottom, else as few as hold them in
  // full trees.
  static int parts_of(std::size_t count) {
    if (count <= BoxTree::kWidth) return static_cast<int>(count);
    std::size_t full = BoxTree::kWidth;
    while (full * BoxTree::kWidth < count) full *= BoxTree::kWidth;
    return static_cast<int>((count + full - 1) / full);
  }

  std::int32_t add_node(std::size_t first, std::size_t last) {
    const auto id = tree_.nodes_.size();
    tree_.nodes_.emplace_back();
    const Mat3 axes = axes_of({first, last});
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f c = axes.col(k).cast<float>();
      tree_.nodes_[id].column[k] = Quad{c[0], c[1], c[2], 0};
    }
    std::vector<Range> parts;
    divide({first, last}, parts_of(last - first), parts);
    for (int lane = 0; lane < BoxTree::kWidth; ++lane) {
      if (lane >= static_cast<int>(parts.size())) {
        leave_empty(id, lane);
        continue;
      }
      const auto [from, to] = parts[lane];
      const auto [low, high] = bounds(axes, {from, to});
      const std::int32_t child =
          to - from == 1 ? ~static_cast<std::int32_t>(from) : add_node(from, to);
      set_lane(id, lane, low, high, child);
      set_spread(id, lane, axes.row(2), {from, to});
    }
    note_same(tree_.nodes_[id]);
    return static_cast<std::int32_t>(id);
  }

  // Triangles that all face within an angle of a normal spread by no more than that angle about the
  // axis; a box within a ball has its half diagonal within the ball's radius.
  static void note_same(BoxTree::Node& node) {
    node.best_spread_cosine = -2;
    node.least_half_diagonal2 = kInfinity;
    for (int lane = 0; lane < BoxTree::kWidth; ++lane) {
      float diagonal2 = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const float side = get(node.high[axis], lane) - get(node.low[axis], lane);
        diagonal2 += side * side;
      }
      if (!(get(node.low[0], lane) < kInfinity)) continue;
      node.least_half_diagonal2 = std::min(node.least_half_diagonal2, 0.25F * diagonal2);
      node.best_spread_cosine = std::max(node.best_spread_cosine, get(node.spread_cosine, lane));
    }
  }

  // Rows are the node's axes. A node whose triangles face all ways keeps the coordinate axes.
  Mat3 axes_of(Range range) const {
    Vec3 sum = Vec3::Zero();
    double area = 0;
    for (std::size_t i = range.first; i < range.second; ++i) {
      const Triangle& t = mesh_.triangles[order_[i]];
      const Vec3& a = mesh_.points[t[0]];
      const Vec3 n = (mesh_.points[t[1]] - a).cross(mesh_.points[t[2]] - a);
      sum += n;
      area += n.norm();
    }
    constexpr double kFacesOneWay = 0.5;  // [-] below it a flat box gains nothing
    if (!(sum.norm() > kFacesOneWay * area)) return Mat3::Identity();
    Mat3 axes;
    axes.row(2) = sum.normalized();
    axes.row(0) = Vec3(axes.row(2)).unitOrthogonal();
    axes.row(1) = Vec3(axes.row(2)).cross(Vec3(axes.row(0)));
    return axes.cast<float>().cast<double>();
  }

  std::pair<Vec3, Vec3> bounds(const Mat3& axes, Range range) const {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (std::size_t i = range.first; i < range.second; ++i)
      for (const std::int32_t v : mesh_.triangles[order_[i]]) {
        const Vec3 p = axes * (mesh_.points[v] - tree_.center_);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    return {low - slack_ * Vec3::Ones(), high + slack_ * Vec3::Ones()};
  }

  static void set(Lanes& lanes, int lane, float value) {
    if (lane < 4)
      lanes.low[lane] = value;
    else
      lanes.high[lane - 4] = value;
  }

  static float get(const Lanes& lanes, int lane) {
    return lane < 4 ? lanes.low[lane] : lanes.high[lane - 4];
  }

  void set_lane(std::size_t id, int lane, const Vec3& low, const Vec3& high, std::int32_t child) {
    BoxTree::Node& node = tree_.nodes_[id];
    for (int axis = 0; axis < 3; ++axis) {
      set(node.low[axis], lane, std::nextafter(static_cast<float>(low[axis]), -kInfinity));
      set(node.high[axis], lane, std::nextafter(static_cast<float>(high[axis]), kInfinity));
    }
    node.child[lane] = child;
  }

  void set_spread(std::size_t id, int lane, const Vec3& axis, Range range) {
    constexpr double kRounding = 1e-5;  // [-] of single precision, on the safe side
    constexpr float kAnyDirection = -2;
    double least = 1;
    bool border = false;
    for (std::size_t i = range.first; i < range.second; ++i) {
      least = std::min(least, axis.dot(normals_[order_[i]]));
      border = border || (!border_.empty() && border_[order_[i]] != 0);
    }
    const double cosine = std::max(-1.0, least - kRounding);
    BoxTree::Node& node = tree_.nodes_[id];
    set(node.spread_cosine, lane, border ? kAnyDirection : static_cast<float>(cosine));
    set(node.spread_sine, lane, static_cast<float>(std::sqrt(std::max(0.0, 1 - cosine * cosine))));
  }

  void leave_empty(std::size_t id, int lane) {
    BoxTree::Node& node = tree_.nodes_[id];
    for (int axis = 0; axis < 3; ++axis) {
      set(node.low[axis], lane, kInfinity);
      set(node.high[axis], lane, -kInfinity);
    }
    node.child[lane] = 0;
  }

  const SurfaceMesh& mesh_;
  const std::vector<char>& border_;
  BoxTree& tree_;
  double slack_ = 0;
  std::vector<Vec3> centroids_, normals_;
  std::vector<std::int32_t> order_;
};

std::pair<BoxTree, std::vector<std::int32_t>> BoxTree::build(const SurfaceMesh& mesh,
                                                             const std::vector<char>& border) {
  BoxTree tree;
  std::vector<std::int32_t> order = BoxTreeBuilder(mesh, border, tree).run();
  return {std::move(tree), std::move(order)};
}

}  // namespace palpate::haptics
