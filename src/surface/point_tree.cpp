// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/point_tree.hpp"

#include <algorithm>
#include <limits>

namespace palpate::surface {

PointTree::PointTree(const std::vector<Vec3>& points) : axis_(points.size(), 0) {
  items_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    items_.push_back({points[i], static_cast<std::int32_t>(i)});
  build(0, items_.size());
}

void PointTree::build(std::size_t begin, std::size_t end) {
  if (end - begin <= kLeaf) return;
  Vec3 low = items_[begin].p, high = low;
  for (std::size_t i = begin; i < end; ++i) {
    low = low.cwiseMin(items_[i].p);
    high = high.cwiseMax(items_[i].p);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto from = items_.begin();
  std::nth_element(from + static_cast<std::ptrdiff_t>(begin),
                   from + static_cast<std::ptrdiff_t>(middle),
                   from + static_cast<std::ptrdiff_t>(end), [axis](const Item& a, const Item& b) {
                     return a.p[axis] < b.p[axis] || (a.p[axis] == b.p[axis] && a.index < b.index);
                   });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

// Visit offers `reach2()`, the squared radius still of interest, and `add(distance2, point)`.
template <class Visit>
void PointTree::descend(const Vec3& p, std::size_t begin, std::size_t end, Visit& visit) const {
  if (end - begin <= kLeaf) {
    for (std::size_t i = begin; i < end; ++i)
      visit.add((items_[i].p - p).squaredNorm(), items_[i].index);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const double offset = p[axis_[middle]] - items_[middle].p[axis_[middle]];
  const bool low_first = offset < 0;
  if (low_first)
    descend(p, begin, middle, visit);
  else
    descend(p, middle + 1, end, visit);
  if (offset * offset > visit.reach2()) return;
  visit.add((items_[middle].p - p).squaredNorm(), items_[middle].index);
  if (low_first)
    descend(p, middle + 1, end, visit);
  else
    descend(p, begin, middle, visit);
}

void PointTree::nearest(const Vec3& p, int k, std::vector<Neighbour>& found) const {
  struct Heap {
    std::vector<Neighbour>& best;
    std::size_t k;
    [[nodiscard]] double reach2() const {
      return best.size() < k ? std::numeric_limits<double>::infinity() : best.front().distance2;
    }
    void add(double distance2, std::int32_t point) {
      const Neighbour n{distance2, point};
      if (best.size() == k) {
        if (!(n < best.front())) return;
        std::pop_heap(best.begin(), best.end());
        best.pop_back();
      }
      best.push_back(n);
      std::push_heap(best.begin(), best.end());
    }
  };
  found.clear();
  if (k <= 0) return;
  Heap heap{found, static_cast<std::size_t>(k)};
  descend(p, 0, items_.size(), heap);
  std::sort(found.begin(), found.end());
}

void PointTree::within(const Vec3& p, double radius, std::vector<Neighbour>& found) const {
  struct Ball {
    std::vector<Neighbour>& in;
    double radius2;
    [[nodiscard]] double reach2() const { return radius2; }
    void add(double distance2, std::int32_t point) {
      if (distance2 <= radius2) in.push_back({distance2, point});
    }
  };
  found.clear();
  Ball ball{found, radius * radius};
  descend(p, 0, items_.size(), ball);
}

}  // namespace palpate::surface
