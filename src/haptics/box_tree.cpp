// SPDX-License-Identifier: Apache-2.0
// Median splits along the longest side of the box of the centroids, two at a time, so that each
// node has four children of nearly equal size. A skin is sampled evenly, where the surface-area
// heuristic gains little over the median and costs a sort per axis.
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
    tree_.nodes_.reserve(order_.size() / 2 + 1);
    add_node(0, order_.size());
    tree_.nodes_.shrink_to_fit();
    return std::move(order_);
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;

  // Both halves differ by at most one triangle; ties are broken by the triangle's number, which
  // makes the order independent of the library's selection algorithm.
  std::size_t split(Range range) {
    Vec3 low = centroids_[order_[range.first]];
    Vec3 high = low;
    for (std::size_t i = range.first; i < range.second; ++i) {
      low = low.cwiseMin(centroids_[order_[i]]);
      high = high.cwiseMax(centroids_[order_[i]]);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = (range.first + range.second) / 2;
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

  std::int32_t add_node(std::size_t first, std::size_t last) {
    const auto id = tree_.nodes_.size();
    tree_.nodes_.emplace_back();
    const Mat3 axes = axes_of({first, last});
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) tree_.nodes_[id].axis[k][j] = static_cast<float>(axes(k, j));
    std::array<Range, BoxTree::kWidth> parts{};
    int count = 0;
    if (last - first <= BoxTree::kWidth) {
      std::sort(order_.begin() + static_cast<std::ptrdiff_t>(first),
                order_.begin() + static_cast<std::ptrdiff_t>(last));
      for (std::size_t i = first; i < last; ++i) parts[count++] = {i, i + 1};
    } else {
      const std::size_t middle = split({first, last});
      const std::size_t quarter = split({first, middle});
      const std::size_t three = split({middle, last});
      parts = {{{first, quarter}, {quarter, middle}, {middle, three}, {three, last}}};
      count = BoxTree::kWidth;
    }
    for (int lane = 0; lane < BoxTree::kWidth; ++lane) {
      if (lane >= count) {
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
    return static_cast<std::int32_t>(id);
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

  void set_lane(std::size_t id, int lane, const Vec3& low, const Vec3& high, std::int32_t child) {
    BoxTree::Node& node = tree_.nodes_[id];
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = std::nextafter(static_cast<float>(low[axis]), -kInfinity);
      node.high[axis][lane] = std::nextafter(static_cast<float>(high[axis]), kInfinity);
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
    node.spread_cosine[lane] = border ? kAnyDirection : static_cast<float>(cosine);
    node.spread_sine[lane] = static_cast<float>(std::sqrt(std::max(0.0, 1 - cosine * cosine)));
  }

  void leave_empty(std::size_t id, int lane) {
    BoxTree::Node& node = tree_.nodes_[id];
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][lane] = kInfinity;
      node.high[axis][lane] = -kInfinity;
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
