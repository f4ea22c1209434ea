// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a point lies under the skin, and whether the scan knows that.
#pragma once
#include <cstdint>
#include <vector>

#include "core/head_surface.hpp"
#include "registration/cut.hpp"
#include "surface/query.hpp"

namespace palpate::skull {

struct SkinDepth {
  double depth = 0;              ///< [mm] shortest distance to the skin; negative outside
  Vec3 gradient = Vec3::Zero();  ///< [-] unit: where depth grows fastest
  bool known = false;            ///< the nearest skin was scanned and belongs to the head's shell
  bool completed = false;        ///< not known, but completed from another head; of its shell too
  bool open = false;  ///< the scan ends here: the nearest skin is a cap, or the point lies outside
                      ///< the skin and behind a cap's plane
};

/// A head's skin for depth queries. Re-entrant; queries allocate nothing.
class SkinField {
 public:
  explicit SkinField(const HeadSurface& head);

  [[nodiscard]] SkinDepth at(const Vec3& p) const;
  /// Depth alone, [mm].
  [[nodiscard]] double depth(const Vec3& p) const { return -query_.signed_distance(p); }
  [[nodiscard]] const registration::ScanEnds& ends() const { return ends_; }
  [[nodiscard]] const surface::SurfaceQuery& query() const { return query_; }

 private:
  surface::SurfaceQuery query_;
  registration::ScanEnds ends_;
  std::vector<std::uint8_t> cap_;        // per triangle: part of a cap
  std::vector<std::uint8_t> unknown_;    // per triangle: filled, a cap, ear or neck
  std::vector<std::uint8_t> completed_;  // per triangle: completed, and neither cap, ear nor neck
};

}  // namespace palpate::skull
