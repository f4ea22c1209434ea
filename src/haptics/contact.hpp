// SPDX-License-Identifier: Apache-2.0
// Where a sphere touches the skin and how deep: the constrained proxy (docs/method/touch.md).
#pragma once
#include <array>
#include <cstdint>

#include "haptics/contact_mesh.hpp"

namespace palpate::haptics {

/// One place where the proxy sphere rests on the skin.
struct ContactPoint {
  SurfacePoint at;
  double weight = 0;  ///< [-] share of the push; all weights sum to 1
};

/// What the tool touches now. With one point, `depth` is R - |C - P|, or R + |C - P| once the
/// tool's centre C is inside; P is the surface point nearest to C. In a crease, where the proxy
/// rests on two or three flanks, `depth` is the length of the way out between them.
struct Contact {
  static constexpr int kMost = 3;
  std::array<ContactPoint, kMost> points{};
  int count = 0;               ///< 0 in free space
  double depth = 0;            ///< [mm] travel of the tool since first contact, > 0
  Vec3 normal = Vec3::Zero();  ///< [-] unit, blended vertex normals: direction of the push
  bool from_inside = false;    ///< the contact did not begin by coming in from outside
};

/// What the search remembers from tick to tick. Plain data: copying it forks the history.
struct ProxyState {
  SurfacePoint anchor;         ///< where the proxy is on the skin, or was last near it
  Vec3 center = Vec3::Zero();  ///< [mm] of the tool in the last tick
  double clearance = 0;        ///< [mm] no skin was nearer than this to `center`
  bool started = false;        ///< false before the first tick
  bool touching = false;
  bool from_inside = false;
};

/// Finds the contact of a sphere of radius `radius` [mm] about `center` [mm].
///
/// From outside, P is the nearest point of the whole surface. Once the centre is inside, P may only
/// move over the surface: it slides to the locally nearest point, and takes the globally nearest
/// one when the surface leads there without climbing more than kRoughness. So neither a thin ear
/// nor a fast move lets the tool through: its proxy stays on the side from which it came, until the
/// tool goes round the rim. A back side touched from an open scan's inside is not felt.
///
/// Deterministic, allocates nothing, does not throw; any number may run at once on one mesh.
/// @cite Zilles & Salisbury 1995 (god-object); Ruspini, Kolarov & Khatib 1997 (sphere proxy)
[[nodiscard]] Contact find_contact(const ContactMesh& mesh, double radius, const Vec3& center,
                                   ProxyState& state);

/// [mm] A scan's roughness: how far a path over the skin may climb away from the tool's centre and
/// still count as leading down to a nearer point. Larger lets the proxy cross small ridges sooner;
/// half the thickness of the thinnest ear rim (1.5 mm) is the upper bound.
inline constexpr double kRoughness = 0.25;
/// [rad] 10 degrees. Flanks that the proxy sees under a smaller angle, or between which the blended
/// normal turns by less than half of it, are one contact; from twice and one and a half times as
/// much on they are two. Smaller would take the facets of a coarse mesh for creases.
inline constexpr double kCreaseAngle = 0.17453292519943295;

}  // namespace palpate::haptics
