// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbours among points: an implicit balanced kd-tree.
#pragma once
#include <cstdint>
#include <vector>

#include "core/types.hpp"

namespace palpate::surface {

/// Built once, O(n log n) time and O(n) memory. Queries are const and re-entrant; the order of
/// results depends on the points alone.
class PointTree {
 public:
  struct Neighbour {
    double distance2 = 0;    ///< squared, in the square of the points' unit
    std::int32_t point = 0;  ///< index into the points given
    bool operator<(const Neighbour& o) const {
      return distance2 < o.distance2 || (distance2 == o.distance2 && point < o.point);
    }
  };

  /// Copies the points, which must be finite.
  explicit PointTree(const std::vector<Vec3>& points);

  /// The k nearest points (all, where there are fewer), nearest first, ties by index.
  /// @param found  overwritten; its memory is reused
  void nearest(const Vec3& p, int k, std::vector<Neighbour>& found) const;
  /// All points within `radius`, in the tree's order.
  void within(const Vec3& p, double radius, std::vector<Neighbour>& found) const;

 private:
  static constexpr int kLeaf = 12;  // points per leaf; only speed depends on it
  struct Item {
    Vec3 p;
    std::int32_t index;
  };
  void build(std::size_t begin, std::size_t end);
  template <class Visit>
  void descend(const Vec3& p, std::size_t begin, std::size_t end, Visit& visit) const;

  std::vector<Item> items_;         // a range is split at its middle item
  std::vector<std::uint8_t> axis_;  // of the split, stored at the middle item
};

}  // namespace palpate::surface
