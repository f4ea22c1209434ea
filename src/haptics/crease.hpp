// SPDX-License-Identifier: Apache-2.0
// A sphere in a crease rests on more than one flank.
#pragma once
#include "haptics/contact.hpp"

namespace palpate::haptics {

/// Places the proxy sphere outside the skin near `center` and says on what it rests.
/// @param nearest  the surface point that the proxy touches, as find_contact() keeps it
/// @param behind   `center` lies inside the skin at that point
///
/// The proxy's centre G = C + sum_j lambda_j n_j is the point nearest to C that keeps the distance
/// R from every flank: lambda >= 0 solves the complementarity problem
///   A lambda >= e,  A_jj = 1,  A_jk = max(n_j . n_k, 0),
/// e_j the depth of C against flank j. For two flanks at an angle below 90 degrees that is the
/// exact projection; above it the flanks push independently, which agrees at 90 degrees and keeps
/// the push finite between opposite walls. The projection is continuous in C, where the nearest
/// point alone would jump from flank to flank and shake the hand. Flanks less than kCreaseAngle
/// apart are one.
[[nodiscard]] Contact rest_on_flanks(const ContactMesh& mesh, double radius, const Vec3& center,
                                     const SurfacePoint& nearest, bool behind);

/// What lies beside a proxy that rests at a point.
struct Beside {
  bool nearest = true;  ///< no skin is nearer to the tool than the point
  /// Where `nearest`, the nearest other contact of the proxy, or none; else a point nearer to the
  /// tool than the one asked about.
  SurfacePoint other;
};
/// Looks about the proxy that rests at `point` for a tool whose `center` lies outside: one walk
/// down the tree tells what rest_on_flanks() and a search for the nearest point would find.
[[nodiscard]] Beside look_beside(const ContactMesh& mesh, double radius, const Vec3& center,
                                 const SurfacePoint& point);
/// rest_on_flanks() outside, where look_beside() has found the second flank already.
[[nodiscard]] Contact rest_on_two(const ContactMesh& mesh, double radius, const Vec3& center,
                                  const SurfacePoint& nearest, const SurfacePoint& other);
/// The contact at one point, without looking for others.
[[nodiscard]] Contact rest_on_point(const ContactMesh& mesh, double radius,
                                    const SurfacePoint& point, bool behind);

}  // namespace palpate::haptics
