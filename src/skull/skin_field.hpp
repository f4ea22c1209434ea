// SPDX-License-Identifier: GPL-3.0-or-later
// How deep a point lies under the skin, and whether the scan knows that.
#pragma once
#include <cstdint>
#include <optional>
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

/// Where a straight way out of the bone leaves the skin.
struct SkinExit {
  double length = 0;           ///< [mm]
  Vec3 normal = Vec3::Zero();  ///< [-] unit, of the skin there, outwards
};

/// A head's skin for depth queries. Re-entrant; queries allocate nothing.
class SkinField {
 public:
  explicit SkinField(const HeadSurface& head);

  [[nodiscard]] SkinDepth at(const Vec3& p) const;
  /// Depth alone, [mm].
  [[nodiscard]] double depth(const Vec3& p) const { return -query_.signed_distance(p); }
  /// Along `direction` [-] from p; nothing where that is further than `reach` [mm], or the skin
  /// there was not scanned. Skin of the neck counts.
  [[nodiscard]] std::optional<SkinExit> exit(const Vec3& p, const Vec3& direction,
                                             double reach) const;
  [[nodiscard]] const registration::ScanEnds& ends() const { return ends_; }
  [[nodiscard]] const surface::SurfaceQuery& query() const { return query_; }

 private:
  surface::SurfaceQuery query_;
  registration::ScanEnds ends_;
  std::vector<Vec3> normal_;             // per triangle: unit, outwards
  std::vector<std::uint8_t> cap_;        // per triangle: part of a cap
  std::vector<std::uint8_t> unknown_;    // per triangle: filled, a cap, ear or neck
  std::vector<std::uint8_t> scanned_;    // per triangle: neither filled nor a cap
  std::vector<std::uint8_t> completed_;  // per triangle: completed, and neither cap, ear nor neck
};

}  // namespace palpate::skull
