// SPDX-License-Identifier: GPL-3.0-or-later
// What carries the skin: bone, and where other organs do, the globe of the eye and the cartilage of
// the nose. Lips lie on the teeth, which the skull has.
#pragma once
#include "core/head_surface.hpp"
#include "core/organs.hpp"
#include "core/skull.hpp"
#include "surface/query.hpp"

namespace palpate::stiffness {

/// held: no curve on eyes, nose and lips (source 4.4.1). supported: bodies of their own.
enum class Organs { held, supported };

struct OrganOptions {
  Organs organs = Organs::supported;
  double globe_radius = 12;  ///< [mm] Bekerman et al. 2014, J Ophthalmol 503645: 24.2 x 23.7 x 23.4
  double lid = 3;            ///< [mm] lid in front of the globe; ultrasound: 2.9 upper, 3.3 lower
  double nose_cover = 4.5;   ///< [mm] skin over cartilage: the depth table's mid-nasal row
  double cover_sd = 1.5;     ///< [mm] of both covers; that row's SD
  /// [mm/N] >= 0: how far the body itself gives way. An assumption of the right order, not a
  /// measurement; vertices on such a body say so in their error.
  double give = 1;
  double give_error = 0.5;  ///< [-] of the travel, where the body carries all
};

/// Bone and organs as one body for rays from the skin. Re-entrant.
class Carriers {
 public:
  Carriers(const HeadSurface& head, const SkullFit& skull, const OrganOptions& options);

  [[nodiscard]] const surface::SurfaceQuery& query() const { return query_; }
  /// [-] Share of an organ in what lies under the tool: of rays along -normal from `at` and from
  /// a ring of half the tool's radius around it. 0 on bone alone.
  [[nodiscard]] double organ_share(const Vec3& at, const Vec3& normal, double tool_radius) const;

 private:
  surface::SurfaceQuery query_;
  std::int32_t bone_triangles_ = 0;
};

}  // namespace palpate::stiffness
